#include "burin/capture/same_shot.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <opencv2/imgproc.hpp>
#include <set>
#include <string>
#include <system_error>
#include <tuple>

#include "burin/base/error.h"
#include "burin/base/files/decimals.h"
#include "burin/base/files/input_file.h"
#include "burin/base/limits.h"
#include "burin/capture/photo.h"

namespace burin {
namespace {

namespace fs = std::filesystem;
using enum Finding::Severity;

bool nearly(double a, double b, double share) { return std::abs(a / b - 1) <= share; }

// Compares whole seconds, and fractions if both files have one.
bool at_one_time(double a, double b) {
  const double whole_a = std::floor(a), whole_b = std::floor(b);
  if (whole_a != whole_b) return false;
  const double part_a = a - whole_a, part_b = b - whole_b;
  constexpr double kSameInstant_s = 0.011;  // one file may have two digits, the other three
  return part_a == 0 || part_b == 0 || std::abs(part_a - part_b) < kSameInstant_s;
}

bool same_bytes(const fs::path& a, const fs::path& b) {
  try {
    return read_bytes(a, limit::kPictureBytes, "a photo") == read_bytes(b, limit::kPictureBytes, "a photo");
  } catch (const Error&) {
    return false;  // its own reader reports the problem
  }
}

std::string same_file_words(const fs::path& other) {
  return "holds the same bytes as " + other.filename().string() + " and was passed over";
}

// Merges equal notes about many files, each paired with another file: the first stands for all.
void add_notes(std::vector<Finding>&& notes, std::vector<Finding>& findings) {
  constexpr std::size_t kMost = 4;
  if (notes.size() > kMost) {
    notes.front().what += "; " + counted(notes.size() - 1, "more file") + " likewise for others";
    notes.resize(1);
  }
  append(findings, notes);
}

// Details of a small copy, comparable between pictures of any tone curve and size.
cv::Mat details_of(const PhotoLook& look) {
  constexpr int kWidth = 160;
  const SmallPhoto& small = look.small;
  cv::Mat codes(small.height, small.width, CV_32F);
  std::copy(small.codes.begin(), small.codes.end(), codes.begin<float>());
  const int height = std::max(1, static_cast<int>(std::lround(1.0 * kWidth * small.height / small.width)));
  cv::Mat same_size, smooth, details, local;
  cv::resize(codes, same_size, {kWidth, height}, 0, 0, cv::INTER_AREA);
  cv::GaussianBlur(same_size, smooth, {}, 6);
  details = same_size - smooth;
  // Divided by the local variation: a curve scales the details of bright and dark parts differently.
  cv::GaussianBlur(details.mul(details), local, {}, 6);
  cv::sqrt(local, local);
  const double floor = 0.2 * std::sqrt(cv::mean(details.mul(details))[0]) + 1e-6;
  cv::divide(details, local + floor, details);
  return details;
}

struct Likeness {
  double correlation = 0;
  double shift = 0;  // as a share of the width
};

// Similarity of two photos whose sizes, tone curves and sharpening may differ.
Likeness likeness_of(const PhotoLook& a, const PhotoLook& b) {
  cv::Mat of_a = details_of(a), of_b = details_of(b);
  const double aspect = 1.0 * of_a.rows / of_b.rows;
  if (std::abs(aspect - 1) > 0.04) return {};
  if (of_a.rows != of_b.rows) cv::resize(of_b, of_b, of_a.size(), 0, 0, cv::INTER_AREA);
  Likeness out;
  out.correlation = of_a.dot(of_b) / std::max(std::sqrt(of_a.dot(of_a) * of_b.dot(of_b)), 1e-12);
  cv::Mat window;
  cv::createHanningWindow(window, of_a.size(), CV_32F);
  const cv::Point2d shift = cv::phaseCorrelate(of_a, of_b, window);
  out.shift = std::hypot(shift.x, shift.y) / of_a.cols;
  return out;
}

// A photo's channel mean at full size, and its remainder after a 3 x 3 mean.
std::pair<cv::Mat, cv::Mat> smooth_and_fine(const Photo& photo) {
  const LinearPhoto linear = read_photo(photo);
  const Image& value = linear.value;
  cv::Mat gray(value.height, value.width, CV_32F);
  for (std::size_t i = 0; i < static_cast<std::size_t>(value.width) * value.height; ++i) {
    float sum = 0;
    for (int c = 0; c < value.channels; ++c) sum += value.data[i * value.channels + c];
    gray.at<float>(static_cast<int>(i) / value.width, static_cast<int>(i) % value.width) =
        std::sqrt(std::max(0.0F, sum / static_cast<float>(value.channels)));
  }
  cv::Mat smooth;
  cv::blur(gray, smooth, {3, 3});
  return {smooth, gray - smooth};
}

// True if two photos of one size have the same noise: the finest details correlate at places with least scene detail. A
// photo that was saved again keeps its noise; another exposure of the scene has noise of its own.
bool share_noise(const Photo& a, const Photo& b) {
  const auto [smooth_a, fine_a] = smooth_and_fine(a);
  const auto [smooth_b, fine_b] = smooth_and_fine(b);
  if (fine_a.size() != fine_b.size()) return false;
  constexpr int kBlock = 16;
  struct Block {
    double roughness, ab, aa, bb;
  };
  std::vector<Block> blocks;
  for (int y = 0; y + kBlock <= fine_a.rows; y += kBlock)
    for (int x = 0; x + kBlock <= fine_a.cols; x += kBlock) {
      const cv::Rect at(x, y, kBlock, kBlock);
      cv::Scalar mean, spread;
      cv::meanStdDev(smooth_a(at), mean, spread);
      if (mean[0] > 0.97 || mean[0] < 0.02) continue;  // clipped or black: no noise is left
      const cv::Mat pa = fine_a(at), pb = fine_b(at);
      blocks.push_back({spread[0], pa.dot(pb), pa.dot(pa), pb.dot(pb)});
    }
  const std::size_t plainest = blocks.size() / 10;
  constexpr std::size_t kFewBlocks = 20;
  if (plainest < kFewBlocks) return true;  // no evidence against one shot
  std::nth_element(blocks.begin(), blocks.begin() + static_cast<std::ptrdiff_t>(plainest), blocks.end(),
                   [](const Block& p, const Block& q) { return p.roughness < q.roughness; });
  double ab = 0, aa = 0, bb = 0;
  for (std::size_t i = 0; i < plainest; ++i) {
    ab += blocks[i].ab;
    aa += blocks[i].aa;
    bb += blocks[i].bb;
  }
  // Noise of two exposures correlates by less than 0.01. After saving at JPEG quality 95, 88 and 75, one photo's noise
  // keeps 0.96, 0.5 and 0.2. In a scene that is rough everywhere, two exposures pass for one, which loses only a
  // repeat.
  constexpr double kShared = 0.1;
  return aa <= 0 || bb <= 0 || ab > kShared * std::sqrt(aa * bb);
}

// True for "IMG_1~2", "IMG_1 (1)" and "IMG_1-edited" against "IMG_1".
bool extends_stem(const std::string& longer, const std::string& stem) {
  return longer.size() > stem.size() && longer.starts_with(stem) &&
         std::string("~ (-_").find(longer[stem.size()]) != std::string::npos;
}

bool related_stems(const fs::path& a, const fs::path& b) {
  const std::string p = a.stem().string(), q = b.stem().string();
  return p == q || extends_stem(p, q) || extends_stem(q, p);
}

// A quick check before the long one: true if two small copies of one exposure may show the same.
bool may_show_the_same(const SmallPhoto& a, const SmallPhoto& b) {
  if (a.codes.size() != b.codes.size()) return false;
  constexpr std::size_t kSamples = 1000;
  constexpr int kFar = 65535 / 20;
  const std::size_t step = std::max<std::size_t>(1, a.codes.size() / kSamples);
  std::size_t far = 0, seen = 0;
  for (std::size_t i = 0; i < a.codes.size(); i += step, ++seen) far += std::abs(a.codes[i] - b.codes[i]) > kFar;
  return far * 10 < seen;
}

using ExifPhoto = std::pair<Photo, Exif>;

bool show_one_shot(const ExifPhoto& a, const PhotoLook& look_a, const ExifPhoto& b, const PhotoLook& look_b) {
  const Exif &of_a = a.second, &of_b = b.second;
  if (a.first.light != b.first.light || !may_be_one_shot(of_a, of_b)) return false;
  const bool timed = of_a.time_s && of_b.time_s;
  constexpr double kOneScene = 0.6, kOneScene_shift = 0.01;
  const auto one_scene = [&] {
    const Likeness like = likeness_of(look_a, look_b);
    return like.correlation > kOneScene && like.shift < kOneScene_shift;
  };
  if (of_a.kind != of_b.kind) return (timed || related_stems(a.first.file, b.first.file)) && one_scene();
  if (of_a.width != of_b.width || of_a.height != of_b.height)
    return timed && (related_stems(a.first.file, b.first.file) || one_scene());
  if (!may_show_the_same(look_a.small, look_b.small)) return false;
  const auto same = compare(look_a, exposure_factor(a.first), look_b, exposure_factor(b.first));
  constexpr double kOnePose = 0.9, kOnePose_px = 0.5;
  if (!same || same->correlation < kOnePose || same->shift_px > kOnePose_px) return false;
  return share_noise(a.first, b.first);
}

}  // namespace

bool may_be_one_shot(const Exif& a, const Exif& b) {
  constexpr double kSameSetting = 0.06;  // 1/60 and 1/64; a third of a stop is 26 %
  if (a.time_s && b.time_s && !at_one_time(*a.time_s, *b.time_s)) return false;
  if (a.exposure_s && b.exposure_s && !nearly(*a.exposure_s, *b.exposure_s, kSameSetting)) return false;
  if (a.f_number && b.f_number && !nearly(*a.f_number, *b.f_number, kSameSetting)) return false;
  if (a.iso && b.iso && !nearly(*a.iso, *b.iso, kSameSetting)) return false;
  if (!a.model.empty() && !b.model.empty() && (a.model != b.model || a.make != b.make)) return false;
  return true;
}

void pass_over_copies(std::vector<IncomingPhoto>& photos, std::vector<Finding>& findings) {
  std::vector<bool> out(photos.size(), false);
  std::map<std::uintmax_t, std::vector<std::size_t>> by_size;
  for (std::size_t i = 0; i < photos.size(); ++i) {
    std::error_code error;
    const std::uintmax_t bytes = fs::file_size(photos[i].file, error);
    if (!error) by_size[bytes].push_back(i);
  }
  for (auto& [bytes, alike] : by_size)  // "IMG_1 (1)" is the copy of "IMG_1"
    std::stable_sort(alike.begin(), alike.end(), [&](std::size_t a, std::size_t b) {
      return photos[a].file.stem().string().size() < photos[b].file.stem().string().size();
    });
  std::vector<std::pair<std::size_t, std::size_t>> copies;  // copy, kept
  for (const auto& [bytes, alike] : by_size)
    for (std::size_t k = 1; k < alike.size(); ++k)
      for (std::size_t j = 0; j < k; ++j)
        if (!out[alike[j]] && same_bytes(photos[alike[j]].file, photos[alike[k]].file)) {
          out[alike[k]] = true;
          copies.emplace_back(alike[k], alike[j]);
          break;
        }
  std::sort(copies.begin(), copies.end());
  std::vector<Finding> notes;
  for (const auto& [copy, kept] : copies) {
    if (photos[copy].light == photos[kept].light)
      notes.push_back({FindingCode::photo_copy, note, photos[copy].file, same_file_words(photos[kept].file), ""});
    else
      findings.push_back({FindingCode::photo_copy, error, photos[copy].file,
                          "holds the same bytes as " + photos[kept].file.string(),
                          "one photo shows one lamp: leave it in the folder of the lamp that was on"});
  }
  add_notes(std::move(notes), findings);
  notes.clear();
  for (std::size_t i = 0; i < photos.size(); ++i) {
    if (out[i] || is_raw(photos[i].file)) continue;
    for (std::size_t k = 0; k < photos.size(); ++k) {
      if (out[k] || !is_raw(photos[k].file) || photos[k].light != photos[i].light ||
          photos[k].file.stem() != photos[i].file.stem() || !may_be_one_shot(photos[i].exif, photos[k].exif))
        continue;
      out[i] = true;
      notes.push_back({FindingCode::photo_copy, note, photos[i].file,
                       "was passed over for " + photos[k].file.filename().string(), ""});
      break;
    }
  }
  add_notes(std::move(notes), findings);
  std::size_t i = 0;
  std::erase_if(photos, [&](const IncomingPhoto&) { return out[i++]; });
}

std::vector<bool> twins_of(const std::vector<ExifPhoto>& photos, const std::vector<std::optional<PhotoLook>>& looks,
                           std::vector<Finding>& findings) {
  // Chooses the kept file of a shot: a frequent kind, raw before more bits before HEIC, from which phones make JPEGs.
  // Then the usual size decides, then a name that extends no other's; a copy that a chat program saved has fewer bytes.
  std::map<std::pair<int, int>, int> sizes;
  std::map<std::string, int> kinds;
  std::set<std::string> stems;
  int most = 0;
  for (const auto& [photo, exif] : photos) {
    ++sizes[std::minmax(exif.width, exif.height)];
    most = std::max(most, ++kinds[exif.kind]);
    stems.insert(photo.file.stem().string());
  }
  std::vector<std::pair<bool, std::intmax_t>> copies;  // extends another's name; bytes, negative
  for (const auto& [photo, exif] : photos) {
    const std::string stem = photo.file.stem().string();
    bool extends = false;
    for (std::size_t end = 1; end < stem.size() && !extends; ++end)
      extends = extends_stem(stem, stem.substr(0, end)) && stems.contains(stem.substr(0, end));
    std::error_code error;
    const std::uintmax_t bytes = fs::file_size(photo.file, error);
    copies.emplace_back(extends, error ? 0 : -static_cast<std::intmax_t>(bytes));
  }
  const auto rank = [&](std::size_t i) {
    const auto& [photo, exif] = photos[i];
    return std::tuple(2 * kinds[exif.kind] < most, exif.kind != "raw", -exif.bits, exif.kind != "heif",
                      -sizes[std::minmax(exif.width, exif.height)], copies[i], i);
  };
  std::vector<std::size_t> by_rank(photos.size());
  for (std::size_t i = 0; i < by_rank.size(); ++i) by_rank[i] = i;
  std::sort(by_rank.begin(), by_rank.end(), [&](auto a, auto b) { return rank(a) < rank(b); });
  std::vector<bool> out(photos.size(), false);
  std::vector<Finding> said(photos.size());
  std::vector<std::size_t> kept;
  for (const std::size_t i : by_rank) {
    if (!looks[i]) continue;
    const auto twin = std::find_if(kept.begin(), kept.end(), [&](std::size_t k) {
      return show_one_shot(photos[k], *looks[k], photos[i], *looks[i]);
    });
    if (twin == kept.end()) {
      kept.push_back(i);
      continue;
    }
    out[i] = true;
    const auto& [other, exif] = photos[*twin];
    const std::string name = other.file.filename().string();
    said[i] = {FindingCode::photo_copy, note, photos[i].first.file,
               "was passed over for " + name +
                   (exif.kind == photos[i].second.kind ? ", of which it is a version that was saved again"
                                                       : ", which shows the same shot"),
               ""};
  }
  std::vector<Finding> notes;
  for (std::size_t i = 0; i < photos.size(); ++i)
    if (out[i]) notes.push_back(std::move(said[i]));
  add_notes(std::move(notes), findings);
  return out;
}

namespace {

// The photo as far as a look needs it.
Photo photo_to_look_at(const IncomingPhoto& incoming) {
  Photo out;
  out.file = incoming.file;
  out.light = incoming.light;
  out.exposure_s = incoming.exif.exposure_s.value_or(out.exposure_s);
  out.f_number = incoming.exif.f_number.value_or(kAssumedAperture);
  out.iso = incoming.exif.iso.value_or(out.iso);
  out.encoding = encoding_of(incoming.exif).encoding;
  return out;
}

}  // namespace

std::optional<SharedShot> find_shared_shot(const IncomingPhoto& newcomer, const std::vector<IncomingPhoto>& others,
                                           const std::function<PhotoLook(const Photo&)>& look_of) {
  for (std::size_t k = 0; k < others.size(); ++k) {
    if (others[k].light != newcomer.light) continue;
    std::vector<Finding> said;
    std::vector<IncomingPhoto> both{others[k], newcomer};
    pass_over_copies(both, said);
    if (both.size() == 1) return SharedShot{k, both.front().file != newcomer.file, said.front()};
    if (!may_be_one_shot(newcomer.exif, others[k].exif)) continue;
    const std::vector<ExifPhoto> photos{{photo_to_look_at(others[k]), others[k].exif},
                                        {photo_to_look_at(newcomer), newcomer.exif}};
    const std::vector<bool> goes = twins_of(photos, {look_of(photos[0].first), look_of(photos[1].first)}, said);
    if (goes[0] || goes[1]) return SharedShot{k, goes[1], said.front()};
  }
  return std::nullopt;
}

}  // namespace burin
