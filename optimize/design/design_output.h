// burin/optimize/design/design_output.h - a finished design as files that people and the other parts of Burin read.
//
// In the folder: scratches.csv; preview-VIEW.png (what the view will show), preview-VIEW-start.png, target-VIEW.png,
// achievable-VIEW.png (the target within the contrast that the plain face leaves); contact-sheet.png (a row a view, its
// target at the end of the row, columns the iterations); design-report.json.
//
// design-report.json, "format": "burin/design-report", "version": 1:
//   scratches, started_with, dropped, relocated, pairs, stopped_early      counts
//   simd                                                                   what pictures were computed with: "avx2"
//   carved                                                                 of the scratches: in the metal before
//   dropped_by_limits: { "overlap": 12 }                                   by the machine's and the board's limits
//   loss_start, loss_final, loss_before_drop                                sums over views
//   history: [ { "loss", "views": [..], "seconds", "as_carved" } ]         before each iteration's step; "as_carved":
//                                                                          false (else left out) while it is not known
//                                                                          what grooves leave of those that they cross
//   eye: { "px", "from_m" }                                                the pixels along the longer side that eyes
//                                                                          in the views' places tell apart, and how far
//                                                                          away these are: how good the design is
//                                                                          counts in them
//   views: [ { "view", "light", "rotation_deg", "preview", "start", "target", "achievable" (file names),
//              "eye_psnr_db" (of the eye's pixels: the one figure), "psnr_db", "ssim", "start_psnr_db", "start_ssim",
//              "achievable_psnr_db" (of the pixels of "pixels"), "loss", "exposure",
//              "best_exposure", "ghost": [correlation of the preview with each view's target],
//              "target_correlation": [of this target with each view's target],
//              "color" (of a view in color, whose other figures are over all channels): { "psnr_db": { "red", "green",
//              "blue", "luminance" }, "white_gain": [factors on the channels besides best_exposure] },
//              "tolerance" (if measured; burin/optimize/design/tolerance.h): { "text", "psnr_db", "eye_mm" and
//              "lamp_mm":
//                { "sideways", "up", "depth": [to the minus side, to the plus side] }, "map" (tolerance-VIEW.png:
//                white to blue while less than 3 dB are lost, orange to black beyond), "map_half_mm", "lost_db" } } ]
//   carving_curve (if measured): { "plot" (carving-curve.svg), "points": [ { "scratches", "hours", "psnr_db" and "ssim"
//              (a view) } ] }, from all scratches to those that a tenth of the time leaves
//   contact_sheet, contact_iterations; seconds: { "iterations", "total" }; length_mm: { "total", "mean" };
//   material (optimized numbers only); bench: the bench as used (file name and its numbers); warnings: [..]
#pragma once

#include <filesystem>

#include "burin/base/image.h"
#include "burin/optimize/design_file.h"
#include "burin/optimize/design_result.h"
#include "burin/scene/bench.h"
#include "burin/scene/board.h"

namespace burin {

/// Writes all of it into `folder`, which is made. Each file is written whole or not at all; the report comes last.
void write_design_result(const DesignResult& result, const DesignSpec& spec, const Board& board, const Bench& bench,
                         const std::filesystem::path& folder);

/// A picture as large as the contact sheet shows it: 192 pixels along its longer side, or as it is if smaller.
Image for_contact_sheet(const Image& picture);

/// Pictures side by side, row by row, with a gap; all of one size, in color if one of them is. Missing ones (no pixels)
/// stay dark.
Image tiled(const std::vector<std::vector<Image>>& rows, int gap_px);

}  // namespace burin
