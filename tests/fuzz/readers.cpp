#include "tests/fuzz/readers.h"

#include <OpenImageIO/imageio.h>

#include <cstdio>
#include <stdexcept>

#include "burin/base/error.h"
#include "burin/base/files/files_together.h"
#include "burin/base/files/json_file.h"
#include "burin/base/image.h"
#include "burin/calib/geometry/chessboard.h"
#include "burin/capture/exif.h"
#include "burin/capture/photo.h"
#include "burin/capture/session.h"
#include "burin/capture/tags/tag_detector.h"
#include "burin/optimize/design_file.h"
#include "burin/optimize/duration.h"
#include "burin/optimize/machine_profile.h"
#include "burin/optimize/toolpath/height_map.h"
#include "burin/optimize/toolpath/probe.h"
#include "burin/optimize/toolpath/toml_file.h"
#include "burin/optimize/toolpath/toolpath_check.h"
#include "burin/pictures/linear_picture.h"
#include "burin/pictures/picture_file.h"
#include "burin/render/footprint/ndf_cases.h"
#include "burin/scene/bench.h"
#include "burin/scene/board.h"
#include "burin/scene/board_mesh.h"
#include "burin/scene/coupon.h"
#include "burin/scene/lens.h"
#include "burin/scene/scratches.h"
#include "burin/simulate/bench_truth.h"
#include "tools/hold_out_file.h"
#include "tools/report/residuals.h"

namespace burin {
namespace {

namespace fs = std::filesystem;

void put(const fs::path& file, std::string_view bytes) {
  std::FILE* out = std::fopen(file.c_str(), "wb");
  if (out == nullptr || std::fwrite(bytes.data(), 1, bytes.size(), out) != bytes.size() || std::fclose(out) != 0)
    throw std::runtime_error("the fuzzer cannot write " + file.string());
}

/// What can be read can be written, and what was written can be read again.
void board(const fs::path& file) {
  const fs::path again = file.parent_path() / "again.json";
  write_board(read_board(file), again);
  read_board(again);
}

void bench(const fs::path& file) { read_bench(file); }
void session(const fs::path& file) { read_session(file); }
void design(const fs::path& file) { read_design(file); }
void truth(const fs::path& file) { read_bench_truth(file); }
void coupon(const fs::path& file) { read_coupon(file); }
void heights(const fs::path& file) { read_heights(file); }
void hold_out(const fs::path& file) {
  fs::rename(file, file.parent_path() / "hold-out.json");
  read_hold_out(file.parent_path());
}

void machine(const fs::path& file) {
  const MachineProfile profile = read_machine_profile(file);
  plunge_mm(profile, 0.011);
  depth_of_plunge_mm(profile, 0.011);
}

void toml(const fs::path& file) { read_toml(file, "burin/loop", 1); }

void scratches(const fs::path& file) {
  const fs::path again = file.parent_path() / "again.csv";
  write_scratches(read_scratches(file), again);
  read_scratches(again);
}

void residuals(const fs::path& file) { read_residuals(file); }
void corners(const fs::path& file) { read_corners(file, Chessboard{}, 640, 480); }
void ndf(const fs::path& file) { read_ndf_cases(file); }

void lens(const fs::path& file) {
  const Lens read = read_cameramodel(file);
  constexpr std::size_t kMany = 2000;
  if (read.intrinsics.size() > kMany) return;
  const std::vector<Eigen::Vector3d> p{{0, 0, 1}, {0.1, -0.2, 1}, {1, 1, 0.1}, {0, 0, -1}, {1e9, 0, 1}};
  std::vector<Eigen::Vector2d> q(p.size());
  project(read, p, q);
  std::vector<Eigen::Vector3d> v(q.size());
  unproject(read, q, v);
}

void obj(const fs::path& file) {
  const TriangleMesh mesh = read_obj(file);
  if (mesh.triangle.size() > 100) return;
  BoardMesh(mesh, {120, 120}, "fuzz.obj").first_hit({60, 60, 500}, {0, 0, -1});
}

void gcode(const fs::path& file) {
  static const std::vector<MachineProfile> machines{machine_profile("grbl"), machine_profile("marlin")};
  const std::string text = read_text(file);
  for (const MachineProfile& profile : machines) try {
      replay_gcode(text, profile, file.string());
    } catch (const Error&) {  // the other machine may take it
    }
}

void probe(const fs::path& file) {
  const std::string text = read_text(file);  // log and G-code, with an empty line between
  const std::size_t blank = std::min(text.find("\n\n"), text.size());
  read_probe_log(std::string_view(text).substr(0, blank), file, std::string_view(text).substr(blank), file);
}

/// A journal of files that change together, in a folder from a stranger: whatever it says, what lies outside of that
/// folder stays, and no journal does.
void journal(const fs::path& file) {
  const fs::path around = file.parent_path() / "around", folder = around / "project";
  fs::remove_all(around);
  fs::create_directories(folder / "below");
  fs::create_directory_symlink("..", folder / "out");
  for (const fs::path& in : {around, folder, folder / "below"})
    for (const char* name : {"a.json", "b.json", ".a.part-1-0.json", ".b.part-1-1.json"}) put(in / name, name);
  fs::rename(file, folder / ".burin-change");
  try {
    settle_changes(folder / "a.json");
  } catch (const Error&) {  // of another disk: a person has to remove it
    fs::remove(folder / ".burin-change");
  }
  if (fs::exists(folder / ".burin-change")) throw std::logic_error("the journal is still there");
  std::size_t outside = 0;
  for (const fs::directory_entry& entry : fs::directory_iterator(around)) {
    ++outside;
    if (entry.is_regular_file() && read_text(entry.path()) != entry.path().filename().string())
      throw std::logic_error("a journal has changed what lies outside of its folder");
  }
  constexpr std::size_t kOutside = 5;  // those four, and the project
  if (outside != kOutside) throw std::logic_error("a journal has renamed what lies outside of its folder");
}

void duration(const fs::path& file) { duration_text(duration_from_text(read_text(file))); }

/// As a photo: EXIF, then pixels; and as a target. Large ones only as far as their headers: memory is what limits are
/// for, and the fuzzer is to be quick.
void picture(const fs::path& file) {
  const bool raw = is_raw(file);
  constexpr std::int64_t kManyPixels = 1'000'000;
  const PictureHeader header = read_picture_header(file);
  if (header.width > kManyPixels || header.height > kManyPixels || header.width * header.height > kManyPixels) {
    require_picture_size(header.width, header.height, 0, file.string(), "a fuzzed picture");
    return;
  }
  const Exif exif = read_exif(file);
  Photo photo;
  photo.file = file;
  photo.view = "v";
  photo.exposure_s = 0.01;
  photo.f_number = 8;
  photo.encoding = encoding_of(exif).encoding;
  if (1.0 * exif.width * exif.height > kManyPixels) return;
  try {
    read_photo(photo);
  } catch (const Error&) {  // it may still be a target
  }
  if (!raw) read_linear_luminance(file);
}

/// Any small picture: two bytes of size, the rest its pixels.
void tags(const fs::path& file) {
  const std::string bytes = read_text(file);
  if (bytes.size() < 3) return;
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(bytes[i]); };
  Image image(1 + byte(0) % 96, 1 + byte(1) % 96, 1);
  for (std::size_t i = 0; i < image.data.size(); ++i)
    image.data[i] = static_cast<float>(byte(2 + i % (bytes.size() - 2))) / 255.0F;
  static TagDetector detector("tagStandard41h12");
  detector.detect(image, {}, {});
}

}  // namespace

std::vector<FuzzReader> fuzz_readers() {
  return {{"board", ".json", board},
          {"bench", ".json", bench},
          {"session", ".json", session},
          {"design", ".json", design},
          {"truth", ".json", truth},
          {"coupon", ".json", coupon},
          {"heights", ".json", heights},
          {"hold_out", ".json", hold_out},
          {"machine_json", ".json", machine},
          {"machine_toml", ".toml", machine},
          {"loop_toml", ".toml", toml},
          {"scratches", ".csv", scratches},
          {"residuals", ".vnl", residuals},
          {"corners", ".vnl", corners},
          {"ndf", ".csv", ndf},
          {"lens", ".cameramodel", lens},
          {"obj", ".obj", obj},
          {"gcode", ".gcode", gcode},
          {"probe", ".log", probe},
          {"journal", ".change", journal},
          {"duration", ".txt", duration},
          {"tags", ".bin", tags},
          {"png", ".png", picture},
          {"jpeg", ".jpg", picture},
          {"tiff", ".tif", picture},
          {"exr", ".exr", picture},
          {"hdr", ".hdr", picture},
          {"heif", ".heic", picture},
          {"webp", ".webp", picture},
          {"bmp", ".bmp", picture},
          {"gif", ".gif", picture},
          {"pnm", ".ppm", picture},
          {"dng", ".dng", picture},
          {"cr2", ".cr2", picture},
          {"nef", ".nef", picture},
          {"cr3", ".cr3", picture},
          {"crw", ".crw", picture},
          {"raf", ".raf", picture}};
}

bool read_fuzzed(const FuzzReader& reader, const fs::path& folder, std::string_view bytes) {
  const fs::path file = folder / (std::string("fuzz") + reader.extension);
  put(file, bytes);
  try {
    reader.read(file);
  } catch (const Error&) {
    return false;
  }
  return true;
}

void prepare_fuzz_folder(const fs::path& folder) {
  fs::create_directories(folder);
  put(folder / "camera.cameramodel",
      "{'lensmodel': 'LENSMODEL_PINHOLE', 'intrinsics': [1000, 1000, 320, 240], 'imagersize': [640, 480]}\n");
  put(folder / "board.json", "{\"format\": \"burin/board\", \"version\": 1, \"size_mm\": [120, 120]}\n");
  put(folder / "p.png", "");
}

}  // namespace burin
