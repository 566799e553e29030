// burin/render/footprint/ndf_cases.h - tables of known footprint integrals, and their comparison with the closed form.
//
// A table is CSV with a header line of column names. Each row is one case: one scratch, one footprint, one half vector.
//   hx, hy, hz                half vector in the scratch frame (x across, y along, z up); the value is for h / |h|
//   alpha, width_um, depth_um, L_mm    roughness, w-tilde, depth, length of the scratch
//   x0_mm, y0_mm .. x3_mm, y3_mm       the footprint's corners in the scratch frame, in order
//   Dhat_mm2                  the integral of D over the footprint cut with the scratch (footprint_integral.h)
// Optional columns: id, kind, area_mm2, dDhat_dhx .. dDhat_dhz, dDhat_dalpha, dDhat_dwidth_um, dDhat_ddepth_um,
// dDhat_dL_mm, dDhat_dx0 .. dDhat_dy3, and the darea_ columns of the same names. The reader ignores other columns and
// the order of columns. Lengths are in mm, widths and depths in um, derivatives per those units.
//
// Tolerances of a row:
// - Value: the larger of 1e-9 relative and 1e-14 of (the footprint's diameter)^2 times the peak of D, 1 / (pi alpha^2).
// If D is small, its conditioning in h decides.
// - Area: 1e-9 relative or 1e-14 diameter^2.
// - Gradient: each derivative within 1e-8 of the row's largest of the same integral. From derivatives by h only the
// tangential part g - (g.h) h counts, because D as a function of n.h alone leaves the rest free.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "burin/render/footprint/footprint_integral.h"

namespace burin {

/// One row of a table. Gradients are present only if the table has all their columns.
struct NdfCase {
  std::string id, kind;  ///< id: the row's number from 0 if the table has none
  GrooveSegment groove;
  Quad corners_mm;
  Eigen::Vector3d h_scratch;
  double Dhat_mm2 = 0;
  std::optional<double> area_mm2;
  std::optional<FootprintGradient> Dhat_gradient, area_gradient;  ///< only the fields of that integral are filled
};

/// Comparison of one row. Errors are computed minus table values; relative errors divide by the table's value.
struct NdfComparison {
  std::string id, kind;
  FootprintGradient computed;
  double expected_Dhat_mm2 = 0;
  double error_mm2 = 0;       ///< computed - expected
  double relative_error = 0;  ///< |error| / |expected|; 0 for an exact 0, infinite for an expected 0 missed
  double tolerance_mm2 = 0;
  bool value_ok = false;
  std::optional<double> area_error_mm2;
  bool area_ok = true;
  std::optional<double> gradient_error;       ///< worst of Dhat's derivatives, over the largest of the row
  std::optional<double> area_gradient_error;  ///< as gradient_error, for the area
  std::string worst_derivative;               ///< column of gradient_error or area_gradient_error
  bool gradient_ok = true;

  bool ok() const { return value_ok && area_ok && gradient_ok; }
};

/// Reads a table. Throws Error with file, line and column for:
/// - a missing file, a file without rows, or a missing column;
/// - a value that is not a finite number, or a row with too few or too many values;
/// - a half vector of length 0, alpha outside (0, 1], or a width, depth or length that is not positive.
std::vector<NdfCase> read_ndf_cases(const std::filesystem::path& file);

/// Computes one case in double and compares.
NdfComparison compare(const NdfCase& c);

/// One line for people: id, kind, value, expected, errors, verdict. `ndf_table_header()` returns the column titles, and
/// `ndf_gradient_line()` the computed gradient in the table's order of columns.
std::string ndf_table_header();
std::string ndf_line(const NdfComparison& c);
std::string ndf_gradient_line(const NdfComparison& c);

/// "150 rows, 150 within tolerance; worst value error 3.1e-04 of its tolerance (row 17); worst gradient error ...".
std::string ndf_summary(const std::vector<NdfComparison>& rows);

}  // namespace burin
