#include "tools/new/pictures.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cctype>
#include <cmath>
#include <exception>
#include <set>

#include "burin/base/error.h"
#include "burin/base/files/file_names.h"
#include "burin/base/files/json_file.h"
#include "burin/optimize/target.h"
#include "burin/pictures/linear_picture.h"
#include "burin/pictures/picture.h"
#include "burin/pictures/picture_header.h"
#include "tools/drawing/label.h"

namespace burin {
namespace {

namespace fs = std::filesystem;

constexpr int kSmall = 640;     // pixels: sufficient for display
constexpr int kLargest = 2400;  // above the resolution of any design

Image at_most(const Image& image, int longest) {
  const double scale = static_cast<double>(longest) / std::max(image.width, image.height);
  if (scale >= 1) return image;
  const auto side = [&](int pixels) { return std::max(1, static_cast<int>(std::lround(pixels * scale))); };
  return resized(image, side(image.width), side(image.height));
}

bool is_linear(const fs::path& file) {
  const std::string kind = picture_kind(file);
  return kind == "openexr" || kind == "hdr";
}

// "My cat (2).jpg" becomes "My-cat-2".
std::string view_name(const fs::path& file, std::size_t number) {
  std::string name;
  bool letters = false;
  for (const char c : file.stem().string()) {
    const auto byte = static_cast<unsigned char>(c);
    const bool plain = byte >= 0x80 || std::isalnum(byte) != 0 || c == '_';  // letters of all languages
    letters = letters || (plain && c != '_');
    if (plain)
      name += c;
    else if (!name.empty() && name.back() != '-')
      name += '-';
  }
  while (!name.empty() && name.back() == '-') name.pop_back();
  constexpr std::size_t kLongest = 40;
  if (name.size() > kLongest) {
    std::size_t end = kLongest;
    while (end > 0 && (static_cast<unsigned char>(name[end]) & 0xC0) == 0x80) --end;  // not within a letter
    name.resize(end);
  }
  return letters ? name : fmt::format("picture-{}", number);
}

// "name-2" for the second. Case-insensitive, like some file systems.
template <typename WithNumber>
std::string unique(const std::string& name, std::set<std::string>& taken, WithNumber with_number) {
  std::string out = name;
  for (int i = 2; !taken.insert(lower_case(out)).second; ++i) out = with_number(i);
  return out;
}

void fail_unless_text(const fs::path& file) {
  try {
    (void)Json(file.filename().string()).dump();
  } catch (const Json::exception&) {
    fail(file.string(), "has a name that is not UTF-8 text", "rename the file");
  }
}

Image luminance_encoded(const Image& image, bool linear) {
  Image gray = luminance(image);
  if (linear)
    for (float& v : gray.data) v = linear_to_srgb(std::clamp(v, 0.0F, 1.0F));
  return gray;
}

// Chooses the background of a transparent picture. Transparent areas should show nothing. On metal this is black,
// except for dark pictures, which are visible on white only. `image`: over white. Returns the background's name; empty
// for a (nearly) opaque picture.
std::string choose_ground(const fs::path& file, Image& image) {
  std::optional<Image> on_black = read_large_picture_on_black(file, kLargest);
  if (!on_black) return "";
  double there = 0, light = 0;  // opaque share, and its luminance
  const Image over_white = luminance(image), over_black = luminance(*on_black);
  for (std::size_t i = 0; i < over_white.data.size(); ++i) {
    there += 1 - (over_white.data[i] - over_black.data[i]);
    light += over_black.data[i];
  }
  constexpr double kNearlyAll = 0.98, kLight = 0.5;
  const double share = there / static_cast<double>(over_white.data.size());
  if (share > kNearlyAll) return "";
  if (!(light > kLight * there)) return "white";
  image = std::move(*on_black);
  return "black";
}

ChosenPicture read_chosen(const fs::path& file) {
  fail_unless_text(file);
  ChosenPicture p;
  Image image = read_large_picture(file, kLargest, p.width, p.height);
  p.file = file;
  p.stored = file.filename();
  const bool linear = is_linear(file), large = std::max(p.width, p.height) > kLargest;
  if (!linear) p.ground = choose_ground(file, image);
  if ((large || p.ground == "black") && !linear) {
    p.smaller = at_most(image, kLargest);
    const std::string extension = lower_extension(file);
    const bool exact = !large || extension == ".png" || extension == ".tif" || extension == ".tiff";
    p.stored = file.stem().string() + (exact ? ".png" : ".jpg");
  }
  p.small = luminance_encoded(at_most(p.smaller ? *p.smaller : image, kSmall), linear);
  const auto [low, high] = std::minmax_element(p.small.data.begin(), p.small.data.end());
  if (*high - *low < 0.02F)
    fail(file.string(),
         std::string(read_picture_header(file).moves
                         ? "its first picture, which alone is used of several, is of one tone"
                         : "is of one tone, so there is nothing to show") +
             (p.ground.empty() ? "" : " (what is see-through counts as " + p.ground + ")"),
         "choose another picture");
  return p;
}

// Reads two at a time, because reading one takes up to 0.8 GB. Reports the first error in their order.
std::vector<ChosenPicture> read_all_chosen(const std::vector<fs::path>& files) {
  constexpr int kAtOnce = 2;
  std::vector<ChosenPicture> pictures(files.size());
  std::vector<std::exception_ptr> errors(files.size());
  std::atomic<std::size_t> first_wrong = files.size();
  tbb::task_arena arena(kAtOnce);
  arena.execute([&] {
    tbb::parallel_for(std::size_t{0}, files.size(), [&](std::size_t i) {
      if (i > first_wrong) return;
      try {
        pictures[i] = read_chosen(files[i]);
      } catch (...) {
        errors[i] = std::current_exception();
        std::size_t before = first_wrong;
        while (i < before && !first_wrong.compare_exchange_weak(before, i)) {
        }
      }
    });
  });
  if (first_wrong < files.size()) std::rethrow_exception(errors[first_wrong]);
  return pictures;
}

}  // namespace

std::vector<ChosenPicture> choose_pictures(const std::vector<fs::path>& files, std::size_t most) {
  if (files.empty())
    fail("pictures", "none is named", "name one to " + std::to_string(most) + ", one for each place to stand");
  if (files.size() > most)
    fail("pictures", std::to_string(files.size()) + " are too many for one board",
         "name at most " + std::to_string(most));
  std::vector<ChosenPicture> pictures = read_all_chosen(files);
  std::set<std::string> views, names;
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    ChosenPicture& p = pictures[i];
    const std::string view = view_name(p.file, i + 1);
    p.view = unique(view, views, [&](int n) { return view + "-" + std::to_string(n); });
    const fs::path stored = p.stored;
    p.stored = unique(stored.string(), names, [&](int n) {
      return stored.stem().string() + "-" + std::to_string(n) + stored.extension().string();
    });
  }
  return pictures;
}

namespace {

LaidPicture laid(const ChosenPicture& p, const Eigen::Vector2d& area_mm) {
  return laid_picture(p.width, p.height, p.fit, p.keep, 0, area_mm);
}

constexpr double kHardly = 0.02;  // of a picture's width or height

std::string percent(double share) { return fmt::format("{:.0f} %", 100 * share); }

}  // namespace

bool has_other_shape(const ChosenPicture& picture, const Eigen::Vector2d& area_mm) {
  const LaidPicture cover = laid_picture(picture.width, picture.height, Fit::cover, Keep::middle, 0, area_mm);
  return std::max(cover.width_lost, cover.height_lost) >= kHardly;
}

void lay_as_usual(ChosenPicture& picture, const Eigen::Vector2d& area_mm) {
  const LaidPicture cover = laid_picture(picture.width, picture.height, Fit::cover, Keep::middle, 0, area_mm);
  constexpr double kTooMuch = 0.45;
  picture.fit = std::max(cover.width_lost, cover.height_lost) > kTooMuch ? Fit::contain : Fit::cover;
  picture.keep = cover.height_lost >= kHardly && picture.fit == Fit::cover ? Keep::top : Keep::middle;
}

std::string crop_in_words(const ChosenPicture& picture, const Eigen::Vector2d& area_mm) {
  std::string out = fmt::format("{}, {} x {} on {:g} x {:g} mm: ", picture.file.filename().string(), picture.width,
                                picture.height, area_mm.x(), area_mm.y());
  if (!picture.ground.empty()) out += "is see-through, laid on " + picture.ground + "; ";
  if (!has_other_shape(picture, area_mm)) return out + "fits";
  const LaidPicture now = laid(picture, area_mm);
  if (picture.fit == Fit::contain) {
    const double width = picture.width * now.mm_per_px / area_mm.x(),
                 height = picture.height * now.mm_per_px / area_mm.y();
    return out + fmt::format("shown whole, {} of the area stays dark", percent(1 - width * height));
  }
  const bool in_width = now.width_lost > now.height_lost;
  const double lost = std::max(now.width_lost, now.height_lost);
  const Keep low = in_width ? Keep::left : Keep::top, high = in_width ? Keep::right : Keep::bottom;
  const char *low_name = in_width ? "left side" : "top", *high_name = in_width ? "right side" : "bottom";
  if (picture.keep == low) return out + fmt::format("the {} loses {}", high_name, percent(lost));
  if (picture.keep == high) return out + fmt::format("the {} loses {}", low_name, percent(lost));
  return out + fmt::format("{} and {} lose {} each", low_name, high_name, percent(lost / 2));
}

std::vector<std::pair<std::size_t, std::size_t>> same_pictures(const std::vector<ChosenPicture>& pictures) {
  constexpr int kSide = 48;  // pixels: enough to distinguish pictures, and too few to show their compression
  constexpr double kAlike = 0.015;
  std::vector<Image> small;
  small.reserve(pictures.size());
  for (const ChosenPicture& p : pictures) small.push_back(resized(p.small, kSide, kSide));
  std::vector<std::pair<std::size_t, std::size_t>> out;
  for (std::size_t later = 1; later < pictures.size(); ++later)
    for (std::size_t earlier = 0; earlier < later; ++earlier) {
      double sum = 0;
      for (std::size_t i = 0; i < small[later].data.size(); ++i)
        sum += std::pow(small[later].data[i] - small[earlier].data[i], 2);
      if (!(sum < kAlike * kAlike * static_cast<double>(small[later].data.size()))) continue;
      out.emplace_back(later, earlier);
      break;
    }
  return out;
}

std::string lay_name(const ChosenPicture& picture) {
  return picture.fit == Fit::contain ? "contain" : keep_name(picture.keep);
}

void lay_as(ChosenPicture& picture, const std::string& name) {
  const std::optional<Keep> keep = keep_named(name);
  if (!keep && name != "contain" && name != "cover")
    fail("how it is laid", "\"" + name + "\" is not known",
         "say top, middle, bottom, left or right (what is kept), or contain");
  picture.fit = name == "contain" ? Fit::contain : Fit::cover;
  picture.keep = keep.value_or(Keep::middle);
}

namespace {

constexpr int kCell = 320, kGap = 12;  // pixels

// Draws the picture, at most a cell wide and high, with its lost part darkened and the kept part framed.
Image framed(const ChosenPicture& p, const Eigen::Vector2d& area_mm) {
  const Image whole = at_most(p.small, kCell);
  const LaidPicture seen = laid(p, area_mm);
  const double shrink = static_cast<double>(whole.width) / p.width;
  const Eigen::Vector2d center = shrink * seen.center_px, half = shrink / seen.mm_per_px / 2 * area_mm;
  constexpr double kFrame = 2;
  Image out(whole.width, whole.height, 3);
  for (int y = 0; y < whole.height; ++y)
    for (int x = 0; x < whole.width; ++x) {
      // Distance of this pixel from the edge of the kept part; negative outside.
      const double inside =
          std::min(half.x() - std::abs(x + 0.5 - center.x()), half.y() - std::abs(y + 0.5 - center.y()));
      const bool frame = p.fit == Fit::cover && inside >= 0 && inside < kFrame;
      const float gray = whole.at(x, y) * (inside < 0 ? 0.3F : 1.0F);
      const std::array<float, 3> color{frame ? 1.0F : gray, frame ? 0.62F : gray, frame ? 0.1F : gray};
      for (int c = 0; c < 3; ++c) out.at(x, y, c) = color[static_cast<std::size_t>(c)];
    }
  return out;
}

// Draws the carve area with the picture, a cell wide or high.
Image on_area(const ChosenPicture& p, const Eigen::Vector2d& area_mm) {
  const double scale = kCell / area_mm.maxCoeff();
  const auto side = [&](double mm) { return std::max(2, static_cast<int>(std::lround(mm * scale))); };
  TargetSpec spec;
  spec.picture = p.file;
  spec.image = p.small;
  spec.fit = p.fit;
  spec.keep = p.keep;
  return load_target(spec, 0, area_mm, side(area_mm.x()), side(area_mm.y())).picture;
}

// Expands gray to the channels of `sheet`.
void put(const Image& image, int x0, int y0, Image& sheet) {
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      for (int c = 0; c < sheet.channels; ++c)
        sheet.at(x0 + x, y0 + y, c) = image.at(x, y, std::min(c, image.channels - 1));
}

}  // namespace

Image crop_sheet(const std::vector<ChosenPicture>& pictures, const Eigen::Vector2d& area_mm) {
  std::vector<std::array<Image, 2>> rows;
  int height = kGap;
  for (const ChosenPicture& p : pictures) {
    rows.push_back({framed(p, area_mm), on_area(p, area_mm)});
    height += kLabelPx + std::max(rows.back()[0].height, rows.back()[1].height) + kGap;
  }
  Image sheet(2 * kCell + 3 * kGap, height, 3, 0.16F);
  int top = kGap;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const auto& row = rows[i];
    put(label(pictures[i].file.filename().string(), 2 * kCell + kGap), kGap, top, sheet);
    top += kLabelPx;
    const int high = std::max(row[0].height, row[1].height);
    for (int k = 0; k < 2; ++k) {
      const Image& image = row[static_cast<std::size_t>(k)];
      put(image, kGap + k * (kCell + kGap) + (kCell - image.width) / 2, top + (high - image.height) / 2, sheet);
    }
    top += high + kGap;
  }
  return sheet;
}

void store_picture(const ChosenPicture& picture, const fs::path& targets_folder) {
  const fs::path to = targets_folder / picture.stored;
  if (picture.smaller) {
    write_picture(*picture.smaller, to);
    return;
  }
  copy_whole(picture.file, to);
}

}  // namespace burin
