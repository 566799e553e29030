#include "burin/capture/photo.h"

#include <OpenImageIO/imageio.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <limits>
#include <memory>
#include <utility>

#include "burin/base/error.h"
#include "burin/base/files/input_file.h"
#include "burin/base/limits.h"
#include "burin/capture/glare.h"
#include "burin/capture/photo_memory.h"
#include "burin/pictures/file_colors.h"
#include "burin/pictures/picture_file.h"

namespace burin {
namespace {

namespace fs = std::filesystem;

// The white level may cut values from here on: 4 % leave room for a sensor's noise at the top and for JPEG's.
constexpr float kClippedFrom = 0.96F;
// Neighbors this bright decide about a pixel instead of its own value. Selection by the value itself would keep noise
// below and drop noise above.
constexpr float kCrowdedFrom = 0.92F;
constexpr int kBloom_px = 2;

// LibRaw settings for measurement: sensor values proportional to light, black at 0, the maker's white level at 1.
OIIO::ImageSpec raw_settings() {
  OIIO::ImageSpec config;
  config.attribute("raw:ColorSpace", "raw");  // no primaries, no curve
  config.attribute("raw:auto_bright", 0);     // no automatic exposure
  config.attribute("raw:use_camera_wb", 0);   // no white balance: neither the camera's ...
  const std::array<float, 4> ones{1, 1, 1, 1};
  config.attribute("raw:user_mul", OIIO::TypeDesc(OIIO::TypeDesc::FLOAT, 4), ones.data());  // ... nor daylight's
  config.attribute("raw:use_camera_matrix", 0);
  config.attribute("raw:adjust_maximum_thr", 0.0F);  // white stays at the maker's level for any picture
  config.attribute("raw:HighlightMode", 0);          // clip, no reconstruction of highlights
  config.attribute("raw:Demosaic", "linear");        // no guessed edges: glints are smaller than the filter array
  config.attribute("raw:user_flip", 0);              // pixels as the sensor has them
  config.attribute("oiio:UnassociatedAlpha", 1);     // (other kinds of files) color not multiplied by alpha
  return config;
}

std::unique_ptr<OIIO::ImageInput> open_photo(const Photo& photo) {
  auto input =
      open_picture(photo.file,
                   {limit::kPhotoPixels, "a photo",
                    "give a PNG, TIFF, JPEG, HEIC, EXR or camera raw file, and copy it again if it is damaged", true},
                   raw_settings());
  const bool is_raw = std::string(input->format_name()) == "raw";
  if (is_raw != (photo.encoding == Encoding::raw))
    fail(photo.file.string(), is_raw ? "is a raw file, but its encoding is not \"raw\"" : "is not a raw file",
         "correct \"encoding\" in the session");
  return input;
}

// Unused lowest bits show the camera's bit depth: 12-bit data in the high end of 16 are multiples of 16, and their
// white is 65520. A dark or flat picture is weaker evidence. It may leave further bits unused, which moves the white
// level by less than 2^-8 at worst.
int unused_low_bits(const std::vector<std::uint16_t>& stored) {
  unsigned used = 0;
  for (const std::uint16_t v : stored) used |= v;
  if (used == 0) return 0;
  int bits = 0;
  while (bits < 8 && !((used >> bits) & 1U)) ++bits;
  return bits;
}

// The camera's actual clipping level, if it is below the file's white level: a spike at the photo's highest value.
float own_top(const std::vector<float>& values, float white_from) {
  const float top = *std::max_element(values.begin(), values.end());
  if (!(top > 0.5F) || top >= white_from) return white_from;
  std::size_t at_top = 0, below = 0;
  for (const float v : values) {
    at_top += v >= top * 0.9999F;
    below += v >= top * 0.98F && v < top * 0.9999F;
  }
  return at_top >= 64 && at_top > 4 * below ? top * 0.96F : white_from;
}

void read_pixels(OIIO::ImageInput& input, const Photo& photo, const OIIO::TypeDesc& type, int channels, void* data) {
  require_whole(input, photo.file);
  require_read(input.read_image(0, 0, 0, channels, type, data), input, photo.file, "copy it from the camera again");
}

bool is_stored_linear(const Photo& photo) { return photo.encoding != Encoding::srgb && photo.response.is_none(); }

float linear_of(const Photo& photo, float stored) {
  const auto plain = photo.response.is_none() ? stored : static_cast<float>(unbent(photo.response, stored));
  return photo.encoding == Encoding::srgb ? srgb_to_linear(plain) : plain;
}

// Converts stored values to sRGB's, by the curves of the file's own profile.
void undo_own_curves(const std::vector<ToSrgbCurve>& curves, std::vector<float>& v) {
  for (std::size_t i = 0; i < v.size(); ++i) v[i] = curve_at(curves[i % curves.size()], v[i]);
}

// Converts 8-bit pixels to linear values by a table.
void read_bytes_linear(OIIO::ImageInput& input, const Photo& photo, int channels, std::vector<float>& v) {
  std::vector<std::uint8_t> stored(v.size());
  read_pixels(input, photo, OIIO::TypeDesc::UINT8, channels, stored.data());
  std::array<float, 256> table{};
  for (int s = 0; s < 256; ++s) table[s] = linear_of(photo, static_cast<float>(s) / 255);
  std::transform(stored.begin(), stored.end(), v.begin(), [&](std::uint8_t s) { return table[s]; });
}

// Converts stored values to linear ones.
void make_linear(const Photo& photo, std::vector<float>& v) {
  if (is_stored_linear(photo)) return;
  if (photo.response.is_none()) {
    for (float& value : v) value = linear_of(photo, value);
    return;
  }
  // A bent curve is slow to evaluate; this table is fine enough for 16 bits.
  constexpr int kSteps = 4096;
  std::vector<float> table(kSteps + 2);
  for (int s = 0; s <= kSteps; ++s) table[s] = linear_of(photo, static_cast<float>(s) / kSteps);
  table[kSteps + 1] = table[kSteps];
  for (float& value : v) {
    const float at = std::clamp(value, 0.0F, 1.0F) * kSteps;
    const int s = static_cast<int>(at);
    value = table[s] + (at - static_cast<float>(s)) * (table[s + 1] - table[s]);
  }
}

// The linear width of a stored level `step` wide, at the squares of i / (count - 1).
std::vector<float> bent_steps(const Photo& photo, double step) {
  constexpr int kCount = 257;
  constexpr float kHalf = 0.002F;  // of the difference for the slope
  std::vector<float> steps(kCount);
  for (int i = 0; i < kCount; ++i) {
    const float root = static_cast<float>(i) / (kCount - 1), v = root * root;
    const float plain = photo.encoding == Encoding::srgb ? linear_to_srgb(v) : v;
    const float stored = std::clamp(static_cast<float>(bent(photo.response, plain)), kHalf, 1 - kHalf);
    std::vector<float> about{stored - kHalf, stored + kHalf};
    make_linear(photo, about);
    steps[i] = static_cast<float>(step) * (about[1] - about[0]) / (2 * kHalf);
  }
  return steps;
}

double balance_of(const Photo& photo, int channels, std::size_t channel) {
  return channels == 3 ? photo.balance[static_cast<Eigen::Index>(channel)] : photo.balance.mean();
}

}  // namespace

LinearPhoto read_photo(const Photo& photo) {
  const std::unique_ptr<OIIO::ImageInput> opened = open_photo(photo);
  OIIO::ImageInput& input = *opened;
  const OIIO::ImageSpec spec = input.spec();
  const std::string kind = input.format_name();
  const int channels = spec.nchannels >= 3 ? 3 : 1;  // 2 and 4 include an alpha channel

  LinearPhoto result;
  result.value = Image(spec.width, spec.height, channels);
  result.stored.lossy = kind == "jpeg";
  std::vector<float>& v = result.value.data;
  const bool sharpened = photo.sharpening.amount > 0;  // removed from the stored values
  const std::vector<ToSrgbCurve> own_curves = photo.encoding == Encoding::srgb
                                                  ? to_srgb_curves(file_colors(input, photo.file), channels)
                                                  : std::vector<ToSrgbCurve>();
  const bool by_table =
      spec.format == OIIO::TypeDesc::UINT8 && !sharpened && own_curves.empty() && !is_stored_linear(photo);
  if (spec.format == OIIO::TypeDesc::UINT16) {
    std::vector<std::uint16_t> stored(v.size());
    read_pixels(input, photo, OIIO::TypeDesc::UINT16, channels, stored.data());
    const int unused = photo.encoding == Encoding::linear ? unused_low_bits(stored) : 0;
    const float white = static_cast<float>((65535 >> unused) << unused);
    std::transform(stored.begin(), stored.end(), v.begin(), [&](std::uint16_t s) { return s / white; });
    result.stored.step = (1 << unused) / static_cast<double>(white);
  } else if (by_table) {
    read_bytes_linear(input, photo, channels, v);
    result.stored.step = 1.0 / 255;
  } else {
    read_pixels(input, photo, OIIO::TypeDesc::FLOAT, channels, v.data());
    if (spec.format == OIIO::TypeDesc::UINT8) result.stored.step = 1.0 / 255;
  }

  if (!own_curves.empty()) undo_own_curves(own_curves, v);
  unsharpened(photo.sharpening, result.value);
  result.stored.srgb = photo.encoding == Encoding::srgb;
  if (!photo.response.is_none()) result.stored.bent_steps = bent_steps(photo, result.stored.step);
  if (!by_table) make_linear(photo, v);
  const float from = own_top(v, kClippedFrom);
  result.clipped.assign(v.size() / channels, 0);
  for (std::size_t i = 0; i < v.size(); ++i)
    if (!(v[i] < from)) {  // NaN included
      result.clipped[i / channels] = 1;
      if (!std::isfinite(v[i])) v[i] = 1;
    }
  if (photo.balance != Eigen::Vector3d::Ones())
    for (std::size_t i = 0; i < v.size(); ++i) v[i] /= static_cast<float>(balance_of(photo, channels, i % channels));
  return result;
}

namespace {

// 1 where an exposure holds a pixel: neither the pixel nor a possible source of its bloom is clipped.
std::vector<std::uint8_t> usable_pixels(const LinearPhoto& photo) {
  const Image& image = photo.value;
  const int w = image.width, h = image.height;
  std::vector<std::uint8_t> usable(photo.clipped.size(), 1);
  const auto spread = [&](int x, int y, int reach, bool itself) {
    for (int yy = std::max(0, y - reach); yy <= std::min(h - 1, y + reach); ++yy)
      for (int xx = std::max(0, x - reach); xx <= std::min(w - 1, x + reach); ++xx)
        if (itself || xx != x || yy != y) usable[static_cast<std::size_t>(yy) * w + xx] = 0;
  };
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x) {
      const std::size_t i = static_cast<std::size_t>(y) * w + x;
      if (photo.clipped[i]) {
        spread(x, y, kBloom_px, true);
        continue;
      }
      for (int c = 0; c < image.channels; ++c)
        if (image.data[i * image.channels + c] >= kCrowdedFrom) {
          spread(x, y, 1, false);
          break;
        }
    }
  return usable;
}

std::string size_text(int width, int height) { return std::to_string(width) + " x " + std::to_string(height); }

[[noreturn]] void fail_size(const Photo& photo, int w, int h, const Photo& first, int w0, int h0) {
  fail(photo.file.string(),
       "is " + size_text(w, h) + " pixels, but " + first.file.string() + " is " + size_text(w0, h0),
       "take all photos of a session with one camera, unrotated, uncropped and at one size");
}

/// The exposures of a bracket in memory, all of one size.
struct Exposures {
  std::vector<LinearPhoto> photos;
  std::vector<std::vector<std::uint8_t>> usable;
  std::vector<double> factor;
  std::vector<int> order;  // from the longest to the shortest
};

Exposures read_exposures(std::span<const Photo> photos) {
  const std::size_t count = photos.size();
  require_bracket_fits(photos);
  Exposures e{std::vector<LinearPhoto>(count), std::vector<std::vector<std::uint8_t>>(count),
              std::vector<double>(count), std::vector<int>(count)};
  for (std::size_t k = 0; k < count; ++k) {
    e.order[k] = static_cast<int>(k);
    e.factor[k] = exposure_factor(photos[k]);
  }
  // Isolated: a waiting thread must not begin another bracket, whose photos would add to these in memory.
  tbb::this_task_arena::isolate([&] {
    tbb::parallel_for(std::size_t{0}, count, [&](std::size_t k) {
      e.photos[k] = read_photo(photos[k]);
      e.usable[k] = usable_pixels(e.photos[k]);
      e.photos[k].clipped = {};
    });
  });
  for (std::size_t k = 1; k < count; ++k) {
    const Image &a = e.photos[k].value, &first = e.photos.front().value;
    if (a.width != first.width || a.height != first.height)
      fail_size(photos[k], a.width, a.height, photos[0], first.width, first.height);
    if (a.channels != first.channels)
      fail(photos[k].file.string(), "has other channels than " + photos[0].file.string(),
           "take all exposures in color, or all in black and white");
  }
  std::stable_sort(e.order.begin(), e.order.end(), [&](int a, int b) { return e.factor[a] > e.factor[b]; });
  return e;
}

/// Value and sigma of pixel i's channels, exposures weighted by their noise; false if no exposure holds it.
bool merge_pixel(const Exposures& e, const NoiseModel& noise, std::size_t i, float* out_value, float* out_sigma) {
  const auto longest = std::find_if(e.order.begin(), e.order.end(), [&](int k) { return e.usable[k][i] != 0; });
  const bool valid = longest != e.order.end();
  const int channels = e.photos.front().value.channels;
  for (int c = 0; c < channels; ++c) {
    const std::size_t j = i * channels + c;
    if (!valid) {
      out_value[c] = static_cast<float>(e.photos[e.order.back()].value.data[j] / e.factor[e.order.back()]);
      out_sigma[c] = std::numeric_limits<float>::infinity();
      continue;
    }
    double value = e.photos[*longest].value.data[j] / e.factor[*longest], weight_sum = 0;
    for (int round = 0; round < 2; ++round) {
      double sum = 0;
      weight_sum = 0;
      for (auto k = longest; k != e.order.end(); ++k) {
        if (!e.usable[*k][i]) continue;
        const double f = e.factor[*k];
        const double weight = f * f / noise.variance(value * f, e.photos[*k].stored);
        sum += weight * (e.photos[*k].value.data[j] / f);
        weight_sum += weight;
      }
      value = sum / weight_sum;
      if (e.photos.size() == 1) break;  // a single exposure needs no weights
    }
    out_value[c] = static_cast<float>(value);
    out_sigma[c] = static_cast<float>(1 / std::sqrt(weight_sum));
  }
  return valid;
}

/// A row of bins, and the remaining pixels below the last.
void merge_row(const Exposures& e, const NoiseModel& noise, GreenSites sites, int row, GrayView* gray,
               MergedView& merged) {
  const Image& like = e.photos.front().value;
  const int channels = like.channels, bin = merged.bin, width = merged.value.width, height = merged.value.height;
  std::vector<double> value(static_cast<std::size_t>(width) * channels, 0), variance(value.size(), 0);
  std::vector<std::uint8_t> valid(width, 1);
  std::vector<int> parts(width, 0);
  std::array<float, 3> v{}, sigma{};
  const int end = row + 1 < height ? (row + 1) * bin : like.height;
  for (int y = row * bin; y < end; ++y)
    for (int x = 0; x < like.width; ++x) {
      const std::size_t i = static_cast<std::size_t>(y) * like.width + x;
      const bool is_valid = merge_pixel(e, noise, i, v.data(), sigma.data());
      if (gray != nullptr) {
        float sum = 0;
        for (int c = 0; c < channels; ++c) sum += v[c];
        gray->value.data[i] = sum / static_cast<float>(channels);
        gray->valid[i] = is_valid;
      }
      const int column = x / bin;
      if (column >= width || y >= (row + 1) * bin) continue;
      valid[column] = valid[column] && is_valid;
      if (bin > 1 && !measured_green(sites, x, y)) continue;
      ++parts[column];
      for (int c = 0; c < channels; ++c) {
        value[static_cast<std::size_t>(column) * channels + c] += v[c];
        variance[static_cast<std::size_t>(column) * channels + c] += static_cast<double>(sigma[c]) * sigma[c];
      }
    }
  const std::size_t at = static_cast<std::size_t>(row) * width;
  std::copy(valid.begin(), valid.end(), merged.valid.begin() + static_cast<std::ptrdiff_t>(at));
  for (std::size_t i = 0; i < value.size(); ++i) {
    const double count = parts[i / channels];
    merged.value.data[at * channels + i] = static_cast<float>(value[i] / count);
    merged.sigma.data[at * channels + i] = static_cast<float>(std::sqrt(variance[i]) / count);
  }
}

}  // namespace

MergedView merge_bracket(std::span<const Photo> photos, const NoiseModel& noise, const MergeOptions& options) {
  if (photos.empty()) fail("merge_bracket", "no photo was given", "give at least one exposure");
  const Exposures exposures = read_exposures(photos);
  const Image& like = exposures.photos.front().value;
  const int bin = std::max(1, options.bin), width = like.width / bin, height = like.height / bin;
  MergedView merged{photos[0].view,
                    photos[0].light,
                    Image(width, height, like.channels),
                    Image(width, height, like.channels),
                    std::vector<std::uint8_t>(static_cast<std::size_t>(width) * height, 0),
                    bin};
  if (options.gray) {
    options.gray->value = Image(like.width, like.height, 1);
    options.gray->valid.assign(exposures.usable.front().size(), 0);
  }
  const GreenSites sites = like.channels == 3 ? photos[0].green_sites : GreenSites::unknown;
  tbb::this_task_arena::isolate([&] {
    tbb::parallel_for(0, height, [&](int row) { merge_row(exposures, noise, sites, row, options.gray, merged); });
    if (bin == 1) keep_green_sites(sites, merged.value);
  });
  return merged;
}

MergedView merge_bracket(std::span<const Photo> photos) { return merge_bracket(photos, estimate_noise(photos)); }

namespace {

std::vector<std::vector<Photo>> grouped(std::span<const Photo> photos) {
  std::vector<std::vector<Photo>> groups;
  for (const Photo& photo : photos) {
    auto group = std::find_if(groups.begin(), groups.end(), [&](const std::vector<Photo>& g) {
      return g.front().view == photo.view && g.front().light == photo.light;
    });
    if (group == groups.end())
      groups.push_back({photo});
    else
      group->push_back(photo);
  }
  return groups;
}

std::vector<NoiseSample> measure(const std::vector<Photo>& bracket) {
  std::vector<LinearPhoto> photos;
  photos.reserve(bracket.size());
  require_bracket_fits(bracket);
  for (const Photo& photo : bracket) photos.push_back(read_photo(photo));
  std::vector<NoiseSample> samples;
  for (std::size_t a = 0; a < photos.size(); ++a)
    for (std::size_t b = 0; b < photos.size(); ++b) {
      const double ratio = exposure_factor(bracket[b]) / exposure_factor(bracket[a]);
      const bool same_size = photos[a].value.width == photos[b].value.width &&
                             photos[a].value.height == photos[b].value.height &&
                             photos[a].value.channels == photos[b].value.channels;
      if (a == b || !same_size || ratio > 1 || (ratio == 1 && b < a)) continue;
      const auto more = noise_between(photos[a], photos[b], ratio);
      samples.insert(samples.end(), more.begin(), more.end());
    }
  if (samples.empty())
    for (const LinearPhoto& photo : photos) {
      const auto more = noise_within(photo);
      samples.insert(samples.end(), more.begin(), more.end());
    }
  return samples;
}

}  // namespace

NoiseModel estimate_noise(std::span<const Photo> photos) {
  constexpr std::size_t kMostBrackets = 4;
  const auto groups = grouped(photos);
  const std::size_t used = std::min(groups.size(), kMostBrackets);
  std::vector<std::vector<NoiseSample>> samples(used);
  std::size_t longest = 1;
  for (const auto& group : groups) longest = std::max(longest, group.size());
  if (photos.empty()) return fit_noise({});
  tbb::task_arena arena(groups_at_once(pixels_of(photos.front().file) * static_cast<double>(longest),
                                       tbb::this_task_arena::max_concurrency()));
  arena.execute([&] {
    tbb::parallel_for(
        std::size_t{0}, used, [&](std::size_t i) { samples[i] = measure(groups[i * groups.size() / used]); },
        tbb::simple_partitioner());
  });
  std::vector<NoiseSample> all;
  for (const auto& more : samples) all.insert(all.end(), more.begin(), more.end());
  return fit_noise(all);
}

std::vector<Bracket> brackets_of(const Session& session) {
  std::vector<Bracket> brackets;
  for (std::size_t i = 0; i < session.photos.size(); ++i) {
    const Photo& photo = session.photos[i];
    auto found = std::find_if(brackets.begin(), brackets.end(),
                              [&](const Bracket& b) { return b.view == photo.view && b.light == photo.light; });
    if (found == brackets.end()) found = brackets.insert(brackets.end(), {photo.view, photo.light, {}});
    found->photos.push_back(static_cast<int>(i));
  }
  return brackets;
}

PhotoSize photo_size(const Session& session) {
  if (session.photos.empty()) fail(session.file.string(), "the session holds no photo", "list at least one photo");
  PhotoSize size;
  for (const Photo& photo : session.photos) {
    const auto input = open_photo(photo);
    const OIIO::ImageSpec& spec = input->spec();
    if (size.width == 0)
      size = {spec.width, spec.height};
    else if (spec.width != size.width || spec.height != size.height)
      fail_size(photo, spec.width, spec.height, session.photos.front(), size.width, size.height);
  }
  return size;
}

namespace {

std::vector<Photo> photos_of(const Session& session, const Bracket& bracket) {
  std::vector<Photo> photos;
  photos.reserve(bracket.photos.size());
  for (const int i : bracket.photos) photos.push_back(session.photos[i]);
  return photos;
}

}  // namespace

std::vector<NoiseModel> session_noise(const Session& session, std::span<const Bracket> brackets) {
  struct Kind {
    Encoding encoding;
    double iso;
    std::vector<Photo> photos;
    NoiseModel noise;
  };
  std::vector<Kind> kinds;
  std::vector<std::size_t> kind_of(brackets.size());
  for (std::size_t b = 0; b < brackets.size(); ++b) {
    const std::vector<Photo> photos = photos_of(session, brackets[b]);
    const Photo& first = photos.front();
    const auto found = std::find_if(kinds.begin(), kinds.end(), [&](const Kind& kind) {
      return kind.encoding == first.encoding && kind.iso == first.iso;
    });
    kind_of[b] = static_cast<std::size_t>(found - kinds.begin());
    if (found == kinds.end()) kinds.push_back({first.encoding, first.iso, {}, {}});
    Kind& kind = kinds[kind_of[b]];
    kind.photos.insert(kind.photos.end(), photos.begin(), photos.end());
  }
  for (Kind& kind : kinds) kind.noise = estimate_noise(kind.photos);
  std::vector<NoiseModel> noise;
  noise.reserve(kind_of.size());
  for (const std::size_t kind : kind_of) noise.push_back(kinds[kind].noise);
  return noise;
}

void for_each_merged(const Session& session, std::span<const Bracket> brackets, std::span<const NoiseModel> noise,
                     int bin, const MergedWork& work) {
  // Two brackets of 24 megapixels in color hold a gigabyte each during the merge; such brackets are merged one at a
  // time.
  constexpr double kManyValues = 60e6;
  const PhotoSize size = photo_size(session);
  std::size_t longest = 1;
  for (const Bracket& b : brackets) longest = std::max(longest, b.photos.size());
  const auto input = open_photo(session.photos.front());
  const double values = 1.0 * size.width * size.height * input->spec().nchannels * static_cast<double>(longest);
  const int at_once = std::max(1, static_cast<int>(kManyValues / values));
  const auto one = [&](std::size_t b) {
    GrayView gray;
    MergedView view = merge_bracket(photos_of(session, brackets[b]), noise[b], {bin, &gray});
    work(b, std::move(view), std::move(gray));
  };
  tbb::task_arena arena(std::min(at_once, tbb::this_task_arena::max_concurrency()));
  if (at_once > 1)
    arena.execute([&] { tbb::parallel_for(std::size_t{0}, brackets.size(), one, tbb::simple_partitioner()); });
  else
    for (std::size_t b = 0; b < brackets.size(); ++b) one(b);
}

Image mean_of_channels(const Image& image) {
  const int n = image.channels;
  Image mean(image.width, image.height, 1);
  for (std::size_t i = 0; i < mean.data.size(); ++i) {
    float sum = 0;
    for (int c = 0; c < n; ++c) sum += image.data[i * n + c];
    mean.data[i] = std::isfinite(sum) ? sum / static_cast<float>(n) : 0;
  }
  return mean;
}

namespace {

Image part_of(const Image& whole, const PixelWindow& window) {
  Image part(window.width, window.height, whole.channels);
  const auto row = static_cast<std::ptrdiff_t>(window.width) * whole.channels;
  for (int y = 0; y < window.height; ++y)
    std::copy_n(&whole.data[(static_cast<std::size_t>(y + window.y0) * whole.width + window.x0) * whole.channels], row,
                part.data.begin() + y * row);
  return part;
}

}  // namespace

MergedView cropped(MergedView whole, const PixelWindow& window) {
  const int x0 = std::clamp(window.x0, 0, whole.value.width), y0 = std::clamp(window.y0, 0, whole.value.height);
  const PixelWindow held{x0, y0, std::clamp(window.x0 + window.width, x0, whole.value.width) - x0,
                         std::clamp(window.y0 + window.height, y0, whole.value.height) - y0};
  MergedView out;
  out.view = std::move(whole.view);
  out.light = std::move(whole.light);
  out.bin = whole.bin;
  out.x0 = x0;
  out.y0 = y0;
  out.whole = coarse_for_glare(mean_of_channels(whole.value));
  if (held.width == 0 || held.height == 0) {
    out.value.channels = whole.value.channels;
    return out;
  }
  out.value = part_of(whole.value, held);
  out.sigma = part_of(whole.sigma, held);
  out.valid.reserve(static_cast<std::size_t>(held.width) * held.height);
  for (int y = 0; y < held.height; ++y) {
    const auto row = whole.valid.begin() + (static_cast<std::ptrdiff_t>(y) + y0) * whole.value.width + x0;
    out.valid.insert(out.valid.end(), row, row + held.width);
  }
  return out;
}

std::vector<MergedView> merge_session(const Session& session, int bin, const KeptPart& kept) {
  // Sizes first: headers are quick to read, and an error then comes early.
  photo_size(session);
  const std::vector<Bracket> brackets = brackets_of(session);
  std::vector<MergedView> merged(brackets.size());
  for_each_merged(session, brackets, session_noise(session, brackets), bin,
                  [&](std::size_t b, MergedView&& view, GrayView&&) {
                    merged[b] = kept ? kept(std::move(view)) : std::move(view);
                  });
  return merged;
}

}  // namespace burin
