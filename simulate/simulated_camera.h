// burin/simulate/simulated_camera.h - photos as a camera would have taken them, of a bench with known truth.
//
// Radiance comes from point sampling (burin/simulate/point_sampler.h). Then, in the order of the light's way:
// the lens's blur and glare, gain * exposure * vignette (docs/model.md 5), a mono sensor's mean of the channels,
// Poisson electrons and read noise, clipping at the white level, what a phone does to its pictures (camera_truth.h),
// rounding to the sensor's bits, the file's encoding, EXIF.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "burin/base/finding.h"
#include "burin/base/image.h"
#include "burin/base/progress.h"
#include "burin/simulate/bench_truth.h"

namespace burin {

/// What of a truth is carved and photographed.
struct SimulateOptions {
  std::filesystem::path scratches;  ///< carve this design instead of the truth's own; empty: the truth's
  std::vector<std::string> views;   ///< photograph from these places only; empty: all
  std::optional<int> samples;       ///< points a pixel with scratches, instead of the truth's
};

/// Carves and photographs a truth. Writes into `out_dir`: the photos, `scratches.csv` (as sent), `carved.csv` (as
/// the machine carved them), `board.json` (as believed) and, if the truth wants one, `session.json`, which comes last:
/// a folder that has it is complete. Same truth, same bits, for any number of threads and any choice of views. Throws
/// Error for a truth that cannot be read, a view that it does not have, or a folder that cannot be written.
void simulate(const std::filesystem::path& truth_json, const std::filesystem::path& out_dir,
              const SimulateOptions& options = {}, const Progress& progress = {});

/// The value that one photo stores for each pixel and channel, before encoding: 0 to 1, noise and clipping included.
/// `radiance` is R, G, B after the lens's blur. `noise_seed` decides the noise; none of it where it is empty.
Image exposed(const BenchTruth& truth, const Image& radiance, const Photo& photo,
              std::optional<std::uint64_t> noise_seed);

}  // namespace burin
