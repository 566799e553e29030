// Calibrates a bench from photos of a board: lens, camera poses and lamp, each with its uncertainty. Simulated photos
// provide ground truth: 02-calibrate-session truth.json FOLDER. Exits with 0 if the estimates of cameras and lamp agree
// with it.
#include <burin/base/error.h>
#include <burin/calib/calibrate.h>
#include <burin/capture/folder_session.h>
#include <burin/simulate/simulated_camera.h>

#include <algorithm>
#include <cstdio>

int main(int argc, char** argv) {
  using namespace burin;
  if (argc != 3) {
    std::fprintf(stderr, "usage: %s truth.json FOLDER\n", argv[0]);
    return 2;
  }
  try {
    const std::filesystem::path folder = argv[2];
    SimulateOptions few;
    few.samples = 4;  // per pixel with grooves; tags and their paper need no more
    simulate(argv[1], folder, few);

    // With your own photos, start here: group them by view, and read their exposures.
    const CaptureResult captured = capture_folder(folder / "photos", folder / "board.json", folder / "captured");
    const Calibration calibration = calibrate(captured.session, read_board(folder / "board.json"));
    write_calibration(calibration, folder / "measured");  // bench.json, camera.cameramodel, residuals.vnl

    const Bench& bench = calibration.bench;
    const BenchTruth truth = read_bench_truth(argv[1]);
    double worst_mm = 0;
    for (const View& view : bench.views) {
      double error_mm = 1e9;  // to the nearest true viewpoint: photos do not contain its name
      for (const TruthView& known : truth.views)
        error_mm = std::min(
            error_mm,
            (view.T_camera_board.inverse().translation() - known.T_camera_board.inverse().translation()).norm());
      std::printf("%s: %.3f px RMS, camera %.2f mm from the truth (sigma %.2f mm)\n", view.name.c_str(),
                  view.reprojection_rms_px.value_or(0), error_mm, view.center_sigma_mm.value().norm());
      worst_mm = std::max(worst_mm, error_mm);
    }
    const double lamp_mm = (bench.lights.front().position_mm - truth.lights.front().position_mm).norm();
    std::printf("lens %s; lamp %.2f mm from the truth\n", bench.lens.model.c_str(), lamp_mm);
    return bench.views.size() == truth.views.size() && worst_mm < 2 && lamp_mm < 10 ? 0 : 1;
  } catch (const Error& error) {  // a sentence for people: the problem, its place, and a remedy
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
