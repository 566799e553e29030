// burin/simulate/simulated_camera.h - synthetic photos of a bench with known ground truth.
//
// Radiance comes from point sampling (burin/simulate/point_sampler.h). The other steps follow the light path:
// - the lens's blur and glare, gain * exposure * vignette (docs/model.md 5), a mono sensor's mean of the channels;
// - Poisson electrons and read noise, clipping at the white level;
// - camera effects of a phone (camera_truth.h), rounding to the sensor's bits, the file's encoding, EXIF.
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

/// Selects scratches, views and samples of a ground truth.
struct SimulateOptions {
  std::filesystem::path scratches;  ///< carve this design instead of the truth's own; empty: the truth's
  std::vector<std::string> views;   ///< render these views only; empty: all
  std::optional<int> samples;       ///< points per pixel on scratches, instead of the truth's
};

/// Carves a board and renders its photos. Writes into `out_dir`: the photos, `scratches.csv` (as sent), `carved.csv`
/// (carved grooves), `board.json` (prior) and, if the truth wants one, `session.json`. The session comes last: a folder
/// with it is complete. Same truth, same bits, for any number of threads and any choice of views. Throws Error for an
/// unreadable truth, an unknown view, or a folder that cannot be written.
void simulate(const std::filesystem::path& truth_json, const std::filesystem::path& out_dir,
              const SimulateOptions& options = {}, const Progress& progress = {});

/// The stored value of each pixel and channel of a photo, before encoding: 0 to 1, noise and clipping included.
/// `radiance` is R, G, B after the lens's blur. `noise_seed` decides the noise; empty: no noise.
Image exposed(const BenchTruth& truth, const Image& radiance, const Photo& photo,
              std::optional<std::uint64_t> noise_seed);

}  // namespace burin
