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
#include "tools/work_lock.h"

namespace burin {

void add_calibrate_command(CLI::App& burin) {
  struct Options {
    std::filesystem::path session, out, camera;
    std::string lens_model, hold_out;
    bool seed_only = false;
    std::string response = "auto";
  };
  auto options = std::make_shared<Options>();
  CLI::App* command =
      burin.add_subcommand("calibrate", "Calibrate lens, camera poses, warp, tags and lamp from a session's photos");
  command->add_option("SESSION.json", options->session, "Read this session.json of burin capture, or its folder")
      ->required();
  command->add_option("--out", options->out, "Write bench.json, camera.cameramodel and residuals.vnl to this folder")
      ->required();
  auto* camera = command->add_option("--camera", options->camera,
                                     "Keep this lens fixed (.cameramodel, also splined) [default: solve for the lens]");
  command->add_flag("--camera-as-seed", options->seed_only, "Solve for the lens too, starting from --camera")
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
    if (std::filesystem::is_directory(options->session)) options->session /= "session.json";  // a round's folder
    const Session session = read_session(options->session);
    const Board board = read_board(session.board);
    const WorkLock lock(options->out, "burin calibrate", WorkLock::Where::new_folders);
    CalibrateOptions o;
    o.lens_model = options->lens_model;
    o.curve = options->response == "none"       ? CurveFrom::none
              : options->response == "brackets" ? CurveFrom::brackets
                                                : CurveFrom::as_told;
    if (!options->camera.empty()) {
      o.lens = read_cameramodel(options->camera);
      o.fix_lens = !options->seed_only;
    }
    ProgressBar bar;
    const KeptMemory kept;
    const Calibration c = calibrate(session, board, o, bar.progress());
    FilesTogether all;
    write_calibration(c, options->out);
    HoldOutFile held;
    if (hold_out->count() > 0) {
      std::vector<std::string> views;
      for (const View& view : c.geometry.views) views.push_back(view.name);
      held.corners =
          hold_out_corners(c.geometry, board, c.pictures, hold_out_folds(options->hold_out, views, o.fix_lens ? 1 : 3),
                           c.solver, bar.progress());
      write_hold_out(held, options->out);
    }
    all.put();
    bar.clear();
    for (const Finding& finding : c.findings) tell(finding);
    const BoardSolution& g = c.geometry;
    print_text("lens     {}: focal lengths {:.2f} and {:.2f} px{}\n", g.lens.model, g.lens.intrinsics[0],
               g.lens.intrinsics[1],
               o.fix_lens ? ", as given" : fmt::format(", +- {:.2f} px", std::sqrt(g.lens_covariance(0, 0))));
    print_text("corners  {:.4f} px RMS per axis, {:.4f} mm on the board (0.01 to 0.05 px is normal)\n", g.rms_px,
               g.rms_board_mm);
    double worst = 0;
    for (const View& view : g.views) worst = std::max(worst, view.center_sigma_mm->maxCoeff());
    print_text("cameras  {}, centers known to {:.3f} mm or better along each axis\n", counted(g.views.size(), "view"),
               worst);
    print_text("board    bow {:.4f}, {:.4f}, {:.4f} mm, +- {:.4f} mm; {} used\n", g.bow_mm[0], g.bow_mm[1], g.bow_mm[2],
               g.bow_sigma_mm.maxCoeff(), counted(g.tags.size(), "tag"));
    if (g.check)
      print_text("check    mrcal's own solver agrees to {:.5f} px, {:.4f} mm\n", g.check->max_shift_px,
                 g.check->max_center_mm);
    if (held.corners) print_text("{}", corners_in_words(*held.corners));
    for (const Light& light : c.bench.lights) {
      print_text("lamp     {} at {:.2f}, {:.2f}, {:.2f} mm", light.id, light.position_mm.x(), light.position_mm.y(),
                 light.position_mm.z());
      if (light.position_sigma_mm)
        print_text(", +- {:.2f}, {:.2f}, {:.2f} mm", light.position_sigma_mm->x(), light.position_sigma_mm->y(),
                   light.position_sigma_mm->z());
      print_text("\n");
    }
    const std::string bench = (options->out / "bench.json").string();
    if (is_in_round(options->out)) {
      print_text("Wrote {}.\n", bench);
      return;
    }
    print_text("Wrote {}; next: burin refine {} --bench {}\n", bench, shell_word(options->session.string()),
               shell_word(bench));
  });
}

}  // namespace burin
