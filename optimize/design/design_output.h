// burin/optimize/design/design_output.h - a finished design as files for people and for other parts of Burin.
//
// The folder contains:
//   scratches.csv
//   preview-VIEW.png         predicted picture of the view
//   preview-VIEW-start.png   the same at the start
//   target-VIEW.png
//   achievable-VIEW.png      the target within the plain face's contrast
//   contact-sheet.png        one row per view, one column per iteration; the target ends the row
//   design-report.json
//
// design-report.json, "format": "burin/design-report", "version": 1:
//   scratches, started_with, dropped, relocated, pairs, stopped_early      counts
//   simd                                                                   SIMD width of the computation: "avx2"
//   carved                                                                 existing grooves among the scratches
//   dropped_by_limits: { "overlap": 12 }                                   by the machine's and the board's limits
//   loss_start, loss_final, loss_before_drop                               sums over views
//   history: [ { "loss", "views": [..], "seconds", "as_carved" } ]         before each iteration's step; "as_carved" is
//                                                                          false (else left out) if the light after
//                                                                          crossings is not current
//   eye: { "px", "from_m" }                                                resolution of an eye at a viewpoint (pixels
//                                                                          along the longer side), and its distance;
//                                                                          the figure of merit uses these pixels
//   views: [ { "view", "light", "rotation_deg", "preview", "start", "target", "achievable" (file names),
//              "eye_psnr_db" (at the eye's pixels: the figure of merit), "psnr_db", "ssim", "start_psnr_db",
//              "start_ssim", "achievable_psnr_db" (at the pixels of "pixels"), "loss", "exposure",
//              "best_exposure", "ghost": [correlation of the preview with each view's target],
//              "target_correlation": [of this target with each view's target],
//              "color" (of a view in color, whose other figures are over all channels): { "psnr_db": { "red", "green",
//              "blue", "luminance" }, "white_gain": [factors on the channels besides best_exposure] },
//              "tolerance" (if measured; burin/optimize/design/tolerance.h): { "text", "psnr_db", "eye_mm" and
//              "lamp_mm":
//                { "sideways", "up", "depth": [to the minus side, to the plus side] }, "map" (tolerance-VIEW.png:
//                white to blue up to a loss of 3 dB, orange to black beyond), "map_half_mm", "lost_db" } } ]
//   carving_curve (if measured): { "plot" (carving-curve.svg), "points": [ { "scratches", "hours", "psnr_db" and "ssim"
//              (one per view) } ] }, from all scratches down to a tenth of the time
//   contact_sheet, contact_iterations; seconds: { "iterations", "total" }; length_mm: { "total", "mean" };
//   material (optimized numbers only); bench: the bench as used (file name and its numbers);
//   notes, warnings: [..]
#pragma once

#include <filesystem>

#include "burin/base/image.h"
#include "burin/optimize/design_file.h"
#include "burin/optimize/design_result.h"
#include "burin/scene/bench.h"
#include "burin/scene/board.h"

namespace burin {

/// Creates `folder` and writes all files into it. Each file is written whole or not at all; the report comes last.
void write_design_result(const DesignResult& result, const DesignSpec& spec, const Board& board, const Bench& bench,
                         const std::filesystem::path& folder);

/// A picture of the contact sheet's size: 192 pixels along its longer side, or unchanged if smaller.
Image for_contact_sheet(const Image& picture);

/// Pictures side by side, row by row, with a gap. All have one size; the result is in color if one of them is. Missing
/// ones (no pixels) stay dark.
Image tiled(const std::vector<std::vector<Image>>& rows, int gap_px);

}  // namespace burin
