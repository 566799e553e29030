#include <CLI/Error.hpp>
#include <CLI/Validators.hpp>
#include <cmath>
#include <filesystem>
#include <memory>

#include "burin/base/files/decimals.h"
#include "burin/base/files/files_together.h"
#include "burin/calib/calibrate.h"
#include "tools/commands.h"
#include "tools/hold_out_file.h"
#include "tools/kept_memory.h"
#include "tools/progress_bar.h"
#include "tools/project.h"
#include "tools/steps.h"
#include "tools/work_lock.h"

namespace burin {
namespace {

void report_geometry(const BoardSolution& g, bool lens_given, Report& report) {
  Facts lens = report.in("lens");
  const double focal_sigma = std::sqrt(g.lens_covariance(0, 0));
  const auto sigma = lens_given ? std::nullopt : std::optional(focal_sigma);
  lens.line("lens     {}: focal lengths {:.2f} and {:.2f} px{}\n", fact("model", g.lens.model),
            fact("focal_x", g.lens.intrinsics[0], "px", sigma), fact("focal_y", g.lens.intrinsics[1], "px"),
            lens_given ? ", as given" : fmt::format(", +- {:.2f} px", focal_sigma));
  report.in("corners").line("corners  {:.4f} px RMS per axis, {:.4f} mm on the board (0.01 to 0.05 px is normal)\n",
                            fact("rms", g.rms_px, "px"), fact("rms_on_board", g.rms_board_mm, "mm"));
  double worst = 0;
  for (const View& view : g.views) worst = std::max(worst, view.center_sigma_mm->maxCoeff());
  report.all().set("views", g.views.size());
  report.line("cameras  {}, centers known to {:.3f} mm or better along each axis\n", counted(g.views.size(), "view"),
              fact("largest_camera_sigma", worst, "mm"));
  Facts warp = report.in("board");
  warp.set("bow", {g.bow_mm[0], g.bow_mm[1], g.bow_mm[2]}, "mm", g.bow_sigma_mm.maxCoeff());
  warp.set("tags", g.tags.size());
  warp.line("board    bow {:.4f}, {:.4f}, {:.4f} mm, +- {:.4f} mm; {} used\n", g.bow_mm[0], g.bow_mm[1], g.bow_mm[2],
            g.bow_sigma_mm.maxCoeff(), counted(g.tags.size(), "tag"));
  if (g.check)
    report.in("check").line("check    mrcal's own solver agrees to {:.5f} px, {:.4f} mm\n",
                            fact("largest_shift", g.check->max_shift_px, "px"),
                            fact("largest_center_shift", g.check->max_center_mm, "mm"));
}

}  // namespace

void report_lamp(const Light& light, int digits, Facts lamp) {
  const Eigen::Vector3d& p = light.position_mm;
  const auto& s = light.position_sigma_mm;
  lamp.set("id", light.id);
  lamp.set("position", {p.x(), p.y(), p.z()}, "mm", s ? Json{s->x(), s->y(), s->z()} : Json());
  lamp.line("lamp     {} at {:.{}f}, {:.{}f}, {:.{}f} mm", light.id, p.x(), digits, p.y(), digits, p.z(), digits);
  if (s) lamp.line(", +- {:.2f}, {:.2f}, {:.2f} mm", s->x(), s->y(), s->z());
}

Report run_calibrate(CalibrateArguments o) {
  if (std::filesystem::is_directory(o.session)) o.session /= "session.json";  // a round's folder
  const Session session = read_session(o.session);
  const Board board = read_board(session.board);
  const WorkLock lock(o.out, "burin calibrate", WorkLock::Where::new_folders);
  CalibrateOptions options;
  options.lens_model = o.lens_model;
  options.curve = o.response == "none"       ? CurveFrom::none
                  : o.response == "brackets" ? CurveFrom::brackets
                                             : CurveFrom::as_told;
  if (!o.camera.empty()) {
    options.lens = read_cameramodel(o.camera);
    options.fix_lens = o.free.empty();
  }
  ProgressBar bar;
  const KeptMemory kept;
  const Calibration c = calibrate(session, board, options, bar.progress());
  FilesTogether all;
  write_calibration(c, o.out);
  HoldOutFile held;
  if (o.holds_out) {
    std::vector<std::string> views;
    for (const View& view : c.geometry.views) views.push_back(view.name);
    held.corners =
        hold_out_corners(c.geometry, board, c.pictures, hold_out_folds(o.hold_out, views, options.fix_lens ? 1 : 3),
                         c.solver, bar.progress());
    write_hold_out(held, o.out);
  }
  all.put();
  bar.clear();
  for (const Finding& finding : c.findings) tell(finding);
  Report report;
  report_geometry(c.geometry, options.fix_lens, report);
  if (held.corners) {
    report.data["hold_out"] = to_json(held);
    report.text += corners_in_words(*held.corners);
  }
  for (const Light& light : c.bench.lights) {
    report_lamp(light, 2, report.add("lamps"));
    report.text += '\n';
  }
  const std::string bench = (o.out / "bench.json").string();
  if (is_in_round(o.out)) {
    report.line("Wrote {}.\n", bench);
    return report;
  }
  report.next = {{"burin", "refine", o.session.string(), "--bench", bench}};
  report.line("Wrote {}; next: {}\n", bench, command_text(report.next.front()));
  return report;
}

void add_calibrate_command(CLI::App& burin) {
  auto options = std::make_shared<CalibrateArguments>();
  CLI::App* command =
      burin.add_subcommand("calibrate", "Calibrate lens, camera poses, warp, tags and lamp from a session's photos");
  command->add_option("SESSION.json", options->session, "Read this session.json of burin capture, or its folder")
      ->required();
  command->add_option("--out", options->out, "Write bench.json, camera.cameramodel and residuals.vnl to this folder")
      ->required();
  auto* camera = command->add_option("--camera", options->camera,
                                     "Keep this lens fixed (.cameramodel, also splined) [default: solve for the lens]");
  command->add_option("--free", options->free, "Solve for the lens too (lens), starting from --camera")
      ->take_all()
      ->expected(1)
      ->check(CLI::IsMember({"lens"}))
      ->needs(camera);
  command
      ->add_option("--lens-model", options->lens_model,
                   "Use LENSMODEL_OPENCV4, 5 or 8 [default: the smallest that the photos support]")
      ->excludes(camera);
  command
      ->add_option("--response", options->response,
                   "Take the camera response from session.json or brackets (auto), from brackets only, or from the "
                   "encoding (none) [default: auto]")
      ->check(CLI::IsMember({"auto", "brackets", "none"}));
  const auto* hold_out =
      command
          ->add_option(
              "--hold-out", options->hold_out,
              "Cross-validate the corners: views (v03,v07), a share (0.25), folds (5), all, or no value for four folds")
          ->expected(0, 1);
  command->footer(example("burin calibrate session/session.json --out bench --hold-out"));
  command->callback([options, hold_out] {
    options->holds_out = hold_out->count() > 0;
    print(run_calibrate(*options));
  });
}

}  // namespace burin
