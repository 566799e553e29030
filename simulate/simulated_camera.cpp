#include "burin/simulate/simulated_camera.h"

#include <OpenImageIO/imageio.h>
#include <OpenImageIO/tiffutils.h>
#include <tbb/parallel_for.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <set>
#include <span>
#include <string_view>
#include <utility>

#include "burin/base/error.h"
#include "burin/base/files/file_names.h"
#include "burin/base/files/files_together.h"
#include "burin/base/files/json_file.h"
#include "burin/pictures/encoded_picture.h"
#include "burin/scene/sensor.h"
#include "burin/simulate/point_sampler.h"

namespace burin {
namespace {

namespace fs = std::filesystem;

// Poisson electrons. Above 200 a normal distribution replaces it: the skewness would be less than 0.07.
double electrons(double mean, std::mt19937_64& random) {
  if (mean <= 0) return 0;
  if (mean < 200) return std::poisson_distribution<int>(mean)(random);
  return std::round(mean + std::sqrt(mean) * std::normal_distribution<>()(random));
}

std::uint64_t seed_of(const BenchTruth& truth, const TruthPhoto& photo) {
  std::uint64_t seed = truth.seed;
  for (const char c : photo.file.generic_string()) seed = (seed ^ static_cast<unsigned char>(c)) * 0x100000001b3ULL;
  return seed;
}

// EXIF keeps times as fractions: 1/60 s, or as many millionths as necessary.
std::array<std::uint32_t, 2> fraction(double value) {
  const double inverse = std::round(1 / value);
  if (value < 1 && std::abs(value * inverse - 1) < 1e-9) return {1, static_cast<std::uint32_t>(inverse)};
  const double unit = value < 1000 ? 1e6 : 1;
  return {static_cast<std::uint32_t>(std::lround(value * unit)), static_cast<std::uint32_t>(unit)};
}

// OpenImageIO 2.4 rounds EXIF's fractions to five digits. This function puts exact ones into an EXIF block (TIFF's
// little-endian layout: directories of 12-byte entries, fractions at an offset), wherever the tag is among them.
void set_fraction(std::span<char> tiff, std::uint16_t tag, double value) {
  const auto number = [&](std::size_t at, int bytes) {
    std::uint32_t v = 0;
    for (int i = 0; i < bytes && at + i < tiff.size(); ++i)
      v |= static_cast<std::uint32_t>(static_cast<unsigned char>(tiff[at + i])) << (8 * i);
    return v;
  };
  constexpr std::uint16_t kExifDirectory = 34665;
  std::size_t directory = number(4, 4);
  for (int depth = 0; depth < 2 && directory != 0 && directory + 2 < tiff.size(); ++depth) {
    const std::size_t count = number(directory, 2);
    std::size_t next = 0;
    for (std::size_t entry = directory + 2; entry < directory + 2 + 12 * count; entry += 12) {
      const std::size_t offset = number(entry + 8, 4);
      if (number(entry, 2) == kExifDirectory) next = offset;
      if (number(entry, 2) != tag || offset + 8 > tiff.size()) continue;
      const auto parts = fraction(value);
      for (int i = 0; i < 8; ++i) tiff[offset + i] = static_cast<char>(parts[i / 4] >> (8 * (i % 4)));
      return;
    }
    directory = next;
  }
}

void set_fractions(std::span<char> tiff, const BenchTruth& truth, const Photo& photo) {
  set_fraction(tiff, 33434, photo.exposure_s);
  set_fraction(tiff, 33437, photo.f_number);
  if (truth.focal_mm) set_fraction(tiff, 37386, *truth.focal_mm);
}

// OpenImageIO 2.4 reads the EXIF chunk of PNG files but writes none. This function inserts it after the header (PNG
// 1.5, eXIf).
void add_exif_to_png(std::string& png, const OIIO::ImageSpec& spec, const BenchTruth& truth, const Photo& photo) {
  constexpr std::size_t kHeaderEnd = 33;  // signature and IHDR
  std::vector<char> exif;
  OIIO::encode_exif(spec, exif, OIIO::endian::little);
  set_fractions(exif, truth, photo);
  const auto big_endian = [](unsigned long v) {
    return std::array<char, 4>{static_cast<char>(v >> 24), static_cast<char>(v >> 16), static_cast<char>(v >> 8),
                               static_cast<char>(v)};
  };
  std::vector<char> chunk{'e', 'X', 'I', 'f'};
  chunk.insert(chunk.end(), exif.begin(), exif.end());
  const auto check =
      big_endian(crc32(0, reinterpret_cast<const Bytef*>(chunk.data()), static_cast<uInt>(chunk.size())));
  const auto length = big_endian(exif.size());
  chunk.insert(chunk.begin(), length.begin(), length.end());
  chunk.insert(chunk.end(), check.begin(), check.end());
  png.insert(kHeaderEnd, chunk.data(), chunk.size());  // OpenImageIO's output is never shorter
}

void exact_exif_of_jpeg(std::string& jpeg, const BenchTruth& truth, const Photo& photo) {
  constexpr std::string_view kMark("Exif\0\0II*\0", 10);
  const auto mark = std::search(jpeg.begin(), jpeg.begin() + std::min<std::ptrdiff_t>(4096, std::ssize(jpeg)),
                                kMark.begin(), kMark.end());
  if (std::distance(mark, jpeg.end()) < 64) return;
  set_fractions(std::span(jpeg).subspan(static_cast<std::size_t>(mark - jpeg.begin()) + 6), truth, photo);
}

// Folders made for photos; the destructor removes empty ones.
struct EmptyFolders {
  std::set<fs::path> folders;
  ~EmptyFolders() {
    std::error_code not_empty;
    for (const fs::path& folder : folders) fs::remove(folder, not_empty);
  }
};

void write_photo(const BenchTruth& truth, const TruthPhoto& photo, const Image& value, const fs::path& file) {
  const std::string extension = lower_extension(file);
  const bool srgb = truth.sensor.encoding == Encoding::srgb;
  const bool jpeg = extension == ".jpg" || extension == ".jpeg";
  if (jpeg && !srgb) fail(file.string(), "a JPEG cannot hold linear values", "name the photo .png or .tif");

  OIIO::ImageSpec spec(value.width, value.height, value.channels,
                       srgb ? OIIO::TypeDesc::UINT8 : OIIO::TypeDesc::UINT16);
  spec.attribute("ExposureTime", static_cast<float>(photo.photo.exposure_s));
  spec.attribute("FNumber", static_cast<float>(photo.photo.f_number));
  spec.attribute("Exif:PhotographicSensitivity", static_cast<int>(std::lround(photo.photo.iso)));
  if (!photo.datetime.empty()) {
    spec.attribute("DateTime", photo.datetime);
    spec.attribute("Exif:DateTimeOriginal", photo.datetime);
  }
  if (!truth.make.empty()) spec.attribute("Make", truth.make);
  if (!truth.model.empty()) spec.attribute("Model", truth.model);
  if (truth.focal_mm) spec.attribute("Exif:FocalLength", static_cast<float>(*truth.focal_mm));
  if (truth.focal_35mm) spec.attribute("Exif:FocalLengthIn35mmFilm", static_cast<int>(std::lround(*truth.focal_35mm)));
  spec.attribute("Exif:ColorSpace", srgb ? 1 : 65535);
  spec.attribute("Orientation", 1);
  if (srgb)
    spec.attribute("oiio:ColorSpace", "sRGB");
  else
    spec.attribute("oiio:ColorSpace", "Linear");
  if (jpeg) spec.attribute("Compression", "jpeg:" + std::to_string(truth.sensor.jpeg_quality));
  if (extension == ".png") spec.attribute("png:compressionLevel", 3);

  std::string bytes;
  if (srgb) {
    std::vector<std::uint8_t> stored(value.data.size());
    std::transform(value.data.begin(), value.data.end(), stored.begin(),
                   [](float v) { return static_cast<std::uint8_t>(std::lround(255 * v)); });
    bytes = encoded_picture(extension, spec, OIIO::TypeDesc::UINT8, stored.data(), file);
  } else {
    const int shift = 16 - truth.sensor.bits;
    const float top = static_cast<float>((1 << truth.sensor.bits) - 1);
    std::vector<std::uint16_t> stored(value.data.size());
    std::transform(value.data.begin(), value.data.end(), stored.begin(),
                   [&](float v) { return static_cast<std::uint16_t>(std::lround(top * v) << shift); });
    bytes = encoded_picture(extension, spec, OIIO::TypeDesc::UINT16, stored.data(), file);
  }
  if (extension == ".png") add_exif_to_png(bytes, spec, truth, photo.photo);
  if (jpeg) exact_exif_of_jpeg(bytes, truth, photo.photo);
  write_file(bytes, file, Durability::by_the_system);
}

}  // namespace

Image exposed(const BenchTruth& truth, const Image& radiance, const Photo& photo,
              std::optional<std::uint64_t> noise_seed) {
  const int w = radiance.width, h = radiance.height, channels = truth.sensor.channels;
  const double scale = truth.optics.gain * exposure_factor(photo);
  const double well_e = truth.sensor.full_well_e * 100 / photo.iso;
  Image value(w, h, channels);
  tbb::parallel_for(0, h, [&](int y) {
    std::mt19937_64 random;
    std::normal_distribution<> normal;
    if (noise_seed) {
      std::seed_seq seed{static_cast<std::uint32_t>(*noise_seed), static_cast<std::uint32_t>(*noise_seed >> 32),
                         static_cast<std::uint32_t>(y)};
      random.seed(seed);
    }
    for (int x = 0; x < w; ++x) {
      const double here = scale * vignette_at(truth.optics.vignette.data(), vignette_radius2(w, h, x, y));
      for (int c = 0; c < channels; ++c) {
        double v = channels == 3 ? radiance.at(x, y, c)
                                 : (radiance.at(x, y, 0) + radiance.at(x, y, 1) + radiance.at(x, y, 2)) / 3.0;
        v *= here;
        if (noise_seed) v = (electrons(v * well_e, random) + truth.sensor.read_noise_e * normal(random)) / well_e;
        value.at(x, y, c) = static_cast<float>(std::clamp(v, 0.0, 1.0));
      }
    }
  });
  return value;
}

void simulate(const fs::path& truth_json, const fs::path& out_dir, const SimulateOptions& options,
              const Progress& progress) {
  BenchTruth truth = read_bench_truth(truth_json);
  if (options.samples) truth.samples = *options.samples;
  for (const std::string& name : options.views)
    if (std::none_of(truth.views.begin(), truth.views.end(), [&](const TruthView& v) { return v.name == name; })) {
      std::string names;
      for (const TruthView& v : truth.views) names += (names.empty() ? "" : ", ") + v.name;
      fail(truth_json.string(), "there is no view \"" + name + "\"", "choose among " + names);
    }
  const Sent sent = options.scratches.empty() ? sent_scratches(truth) : Sent(read_scratches(options.scratches));
  const Carved carved = carved_by(truth, sent);
  const PointSampler sampler(truth, carved);

  make_output_folder(out_dir);
  EmptyFolders empty;
  FilesTogether all;
  // A session of an earlier run would list photos that are about to change.
  if (!truth.writes_session) remove_file(out_dir / "session.json");
  write_scratches(sent.scratches, out_dir / "scratches.csv");
  write_scratches(carved.scratches, out_dir / "carved.csv");
  Board believed = truth.believed;
  believed.scratches = out_dir / "scratches.csv";
  write_board(believed, out_dir / "board.json");

  std::vector<const TruthView*> views;
  for (const TruthView& view : truth.views)
    if (options.views.empty() ||
        std::find(options.views.begin(), options.views.end(), view.name) != options.views.end())
      views.push_back(&view);
  Session session;
  session.board = out_dir / "board.json";
  for (std::size_t i = 0; i < views.size(); ++i) {
    const TruthView& view = *views[i];
    const Progress within = [&](std::string_view, double fraction) {
      if (progress) progress("photographing", (static_cast<double>(i) + fraction) / static_cast<double>(views.size()));
    };
    Bench lamps;  // for their names
    lamps.lights = truth.lights;
    std::vector<std::string> names;
    for (const TruthPhoto& photo : view.photos)
      if (std::find(names.begin(), names.end(), photo.photo.light) == names.end()) names.push_back(photo.photo.light);
    for (const std::string& name : names) {
      const Light light = find_light(lamps, name, truth_json.string());
      std::vector<const TruthPhoto*> photos;
      for (const TruthPhoto& photo : view.photos)
        if (photo.photo.light == name) photos.push_back(&photo);
      const Image radiance = with_glare(blurred(sampler.radiance(view, light, within), truth.optics.psf_sigma_px),
                                        truth.sensor.camera.glare);
      for (const TruthPhoto* photo : photos) {
        const fs::path file = out_dir / photo->file;
        make_output_folder(file.parent_path());
        empty.folders.insert(file.parent_path());
        const std::uint64_t seed = seed_of(truth, *photo);
        write_photo(
            truth, *photo,
            developed(exposed(truth, radiance, photo->photo, seed), truth.sensor.encoding, truth.sensor.camera, seed),
            file);
      }
    }
    for (const TruthPhoto& photo : view.photos) {
      session.photos.push_back(photo.photo);
      session.photos.back().file = out_dir / photo.file;
    }
  }
  if (truth.writes_session) write_session(session, out_dir / "session.json");
  all.put();
}

}  // namespace burin
