// burin probe light - measures a room: photos of a mirror ball on the board become an environment map. The work is in
// burin/calib/light_probe.h.
#include "tools/probe_light_command.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "burin/base/error.h"
#include "burin/base/files/file_names.h"
#include "burin/base/files/files_together.h"
#include "burin/base/image.h"
#include "burin/base/median.h"
#include "burin/calib/light/probe/probe_session.h"
#include "burin/calib/light_probe.h"
#include "burin/pictures/picture.h"
#include "tools/commands.h"
#include "tools/progress_bar.h"
#include "tools/work_lock.h"

namespace burin {
namespace {

struct ProbeLightArguments {
  std::vector<std::filesystem::path> photos;
  std::filesystem::path board, bench, camera, out;
  std::vector<double> reflectance;
  double ball_mm = 0, photographer_deg = LightProbeOptions{}.photographer_deg;
  int width = 0;
};

// Reads a session, or makes one of plain photos, with the lens in EXIF.
Session session_of(const ProbeLightArguments& options, const Board& board, std::optional<Lens>& by_exif,
                   const Progress& progress) {
  if (options.photos.size() == 1 && lower_extension(options.photos.front()) == ".json")
    return read_session(options.photos.front());
  std::vector<Finding> findings;
  FolderSession folder = session_from(named_source(options.photos, findings), board.tags, progress);
  append(findings, folder.findings);
  for (const Finding& finding : findings)
    if (finding.severity == Finding::Severity::error) throw Error(sentence(finding));
  for (const Finding& finding : findings)
    if (finding.severity == Finding::Severity::warning) tell(finding);
  join_dark_views(folder);
  by_exif = lens_by_exif(folder);
  return std::move(folder.session);
}

// Tone-mapped picture for people, with unknown parts striped.
Image to_look_at(const LightProbe& probe) {
  const Image& radiance = probe.radiance;
  std::vector<float> light;
  for (std::size_t i = 0; i < radiance.data.size() / 6; ++i) light.push_back(radiance.data[3 * i + 1]);
  const double scale = 0.35 / std::max(1e-30F, median_in_place(light));
  Image picture(radiance.width, radiance.height, 3);
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x) {
      const bool striped =
          probe.seen[static_cast<std::size_t>(y) * picture.width + x] == Seen::nowhere && (x + y) / 4 % 2 == 0;
      for (int c = 0; c < 3; ++c) {
        const double shown = 1 - std::exp(-scale * radiance.at(x, y, c));
        picture.at(x, y, c) = linear_to_srgb(static_cast<float>((striped ? 0.6 : 1) * shown));
      }
    }
  return picture;
}

// White: seen; red: clipped; orange: seen only past the photographer; black: filled.
Image seen_picture(const LightProbe& probe) {
  Image picture(probe.radiance.width, probe.radiance.height, 3);
  for (std::size_t i = 0; i < probe.seen.size(); ++i) {
    const Seen how = probe.seen[i];
    const bool any = how != Seen::nowhere;
    picture.data[3 * i] = any ? 1.0F : 0.0F;
    picture.data[3 * i + 1] = how == Seen::well ? 1.0F : how == Seen::photographer ? 0.6F : 0.0F;
    picture.data[3 * i + 2] = how == Seen::well ? 1.0F : 0.0F;
  }
  return picture;
}

std::filesystem::path beside(const std::filesystem::path& file, const std::string& ending) {
  return file.parent_path() / (file.stem().string() + ending);
}

void report_probe(const LightProbe& p, bool with_bench, Report& report) {
  Facts ball = report.in("ball");
  ball.set("diameter", 2 * p.ball.radius_mm, "mm", 2 * p.radius_sigma_mm);
  ball.set("center", {p.ball.center_mm.x(), p.ball.center_mm.y(), p.ball.center_mm.z()}, "mm");
  ball.set("reflectance", {p.reflectance.x(), p.reflectance.y(), p.reflectance.z()});
  ball.set("reflectance_by_paper", p.reflectance_by_paper);
  ball.line("ball     {:.2f} +- {:.2f} mm wide, middle at {:.2f}, {:.2f}, {:.2f} mm: {}\n", 2 * p.ball.radius_mm,
            2 * p.radius_sigma_mm, p.ball.center_mm.x(), p.ball.center_mm.y(), p.ball.center_mm.z(),
            std::abs(p.ball.center_mm.z() - p.ball.radius_mm) < 0.5
                ? "it stands on the face"
                : fmt::format("its lowest point is {:.1f} mm above the face", p.ball.center_mm.z() - p.ball.radius_mm));
  report.line("photos   {:>10} {:>9} {:>6} {:>9} {:>12} {:>10} {:>9}\n", "place", "exposures", "tags", "residual",
              "ball, wide", "outline", "residual");
  for (const ProbePlace& place : p.places)
    report.add("places").line("         {:>10} {:>9} {:>6} {:>6.2f} px {:>9.0f} px {:>8.0f} % {:>6.2f} px\n",
                              fact("view", place.view), fact("exposures", place.exposures), fact("tags", place.tags),
                              fact("tags_rms", place.tags_rms_px, "px"), fact("width", 2 * place.radius_px, "px"),
                              fact("outline_found", 100 * place.outline_found, "%"),
                              fact("outline_rms", place.outline_rms_px, "px"));
  if (p.places.size() > 1) report.data["agreement"] = p.agreement;
  report.line(
      "angles   +- {:.2f} degrees, many directions together; a pixel in the ball's middle spans {:.2f} degrees{}\n",
      fact("direction_sigma", p.direction_sigma_deg, "deg"), fact("pixel", p.pixel_deg, "deg"),
      p.places.size() > 1 ? fmt::format("; places agree (correlation {:.2f})", p.agreement) : "");
  report.line(
      "seen     {:.1f} % of the directions above the face; {:.1f} % past the photographer only, {:.2f} % clipped\n",
      fact("seen", 100 * p.seen_share, "%"), fact("photographer", 100 * p.photographer_share, "%"),
      fact("clipped", 100 * p.clipped_share, "%"));
  if (p.reflectance_by_paper)
    report.line(
        "scale    the ball reflects {:.3f}, {:.3f}, {:.3f} (red, green, blue) by the tags' paper, whose pieces "
        "differ by {:.1f} %\n",
        p.reflectance.x(), p.reflectance.y(), p.reflectance.z(), fact("paper_spread", 100 * p.paper_spread, "%"));
  else
    report.line("scale    the ball reflects {:.3f}, {:.3f}, {:.3f} (red, green, blue), as given or assumed\n",
                p.reflectance.x(), p.reflectance.y(), p.reflectance.z());
  report.line("         light in units of {}, by exposure time, ISO and aperture\n",
              with_bench ? "the bench's lamps (its sensor.gain)" : "this camera (no bench was given)");
}

void write_probe(const LightProbe& probe, const std::filesystem::path& out) {
  FilesTogether all;
  write_picture(probe.radiance, out);
  write_picture(seen_picture(probe), beside(out, "-seen.png"));
  write_picture(to_look_at(probe), beside(out, "-look.png"));
  all.put();
}

Report probe_room(const ProbeLightArguments& options) {
  if (lower_extension(options.out) != ".exr")
    fail(options.out.string(), "is no name of an EXR file", "write --out room.exr");
  const Board board = read_board(options.board);
  std::optional<Bench> bench;
  LightProbeOptions how;
  if (!options.bench.empty()) {
    bench = read_bench(options.bench);
    how.bench = &*bench;
  }
  if (!options.camera.empty()) how.lens = read_cameramodel(options.camera);
  if (options.ball_mm > 0) how.ball_mm = options.ball_mm;
  if (!options.reflectance.empty())
    how.reflectance = options.reflectance.size() == 1
                          ? Eigen::Vector3d::Constant(options.reflectance[0]).eval()
                          : Eigen::Vector3d(options.reflectance[0], options.reflectance[1], options.reflectance[2]);
  how.photographer_deg = options.photographer_deg;
  how.width = options.width;
  const WorkLock lock(options.out.parent_path(), "burin probe light", WorkLock::Where::projects);
  ProgressBar bar;
  std::optional<Lens> by_exif;
  const Session session = session_of(options, board, by_exif, bar.progress());
  if (!how.lens && how.bench == nullptr && by_exif) {
    how.lens = by_exif;
    how.lens_is_a_guess = true;
  }
  const LightProbe probe = light_probe(session, board, how, bar.progress());
  bar.clear();
  for (const Finding& finding : probe.findings) tell(finding);
  write_probe(probe, options.out);
  Report report;
  report_probe(probe, bench.has_value(), report);
  const Eigen::Vector3d& d = probe.brightest.direction;
  const double azimuth = std::fmod(std::atan2(d.y(), d.x()) * 180 / std::numbers::pi + 360, 360);
  Facts brightest = report.in("brightest");
  brightest.set("azimuth", azimuth, "deg");
  brightest.set("elevation", std::asin(std::clamp(d.z(), -1.0, 1.0)) * 180 / std::numbers::pi, "deg");
  brightest.set("share", 100 * probe.brightest.irradiance_share, "%");
  report.line(
      "Wrote {}, {} and {}: {:.1f} % of the directions above the face seen, brightest at azimuth {:.1f}, elevation "
      "{:.1f} degrees ({:.0f} % of the face's light); add {{ \"id\": \"room\", \"surroundings\": {{ \"picture\": "
      "\"{}\", "
      "\"frame\": \"board\" }} }} to \"lights\" of bench.json and \"lights\": [\"room\"] to a view of design.json, "
      "then: "
      "burin design design.json --out out\n",
      options.out.string(), beside(options.out, "-seen.png").string(), beside(options.out, "-look.png").string(),
      100 * probe.seen_share, azimuth, std::asin(std::clamp(d.z(), -1.0, 1.0)) * 180 / std::numbers::pi,
      100 * probe.brightest.irradiance_share, options.out.filename().string());
  return report;
}

}  // namespace

void add_probe_light(CLI::App& probe) {
  auto options = std::make_shared<ProbeLightArguments>();
  CLI::App* light =
      probe.add_subcommand("light", "Convert photos of a mirror ball on the tagged board into an environment map");
  light
      ->add_option("PHOTOS", options->photos,
                   "Read these photos, folders or session.json: brackets from two or three places, with EXIF")
      ->required();
  light->add_option("--board", options->board, "Read the tags' places from this board (board.json)")->required();
  light->add_option("--bench", options->bench,
                    "Use lens, tags and units of light of this bench.json, measured at the same zoom and focus");
  light->add_option("--camera", options->camera,
                    "Use this lens (.cameramodel) [default: the bench's, else solved from three or more places]");
  add_length_option(*light, "--ball", options->ball_mm, "Set the ball's diameter [default: estimated from its outline]")
      ->check(CLI::PositiveNumber);
  light
      ->add_option("--reflectance", options->reflectance,
                   "Set the ball's reflectance, one number or R G B [default: estimated from the tags' paper]")
      ->expected(1, 3)
      ->check(CLI::Range(0.01, 1.0));
  light
      ->add_option("--photographer-deg", options->photographer_deg,
                   "Set the half-angle of the cone around each camera that other places fill in, degrees")
      ->check(CLI::Range(0.0, 90.0))
      ->capture_default_str();
  light->add_option("--width", options->width, "Set the panorama's width, pixels [default: the photos' resolution]")
      ->check(CLI::Range(64, 8192));
  light
      ->add_option("--out", options->out,
                   "Write the panorama to this file (room.exr), with room-seen.png and room-look.png")
      ->required();
  light->footer(example("burin probe light ball-photos --board board.json --bench bench.json --out room.exr"));
  light->callback([options] {
    if (options->reflectance.size() == 2)
      throw CLI::ValidationError("--reflectance", "takes one number or three, not two");
    options->width += options->width % 2;
    print(probe_room(*options));
  });
}

}  // namespace burin
