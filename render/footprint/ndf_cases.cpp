#include "burin/render/footprint/ndf_cases.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>

#include "burin/base/error.h"
#include "burin/base/files/table.h"
#include "burin/render/brdf.h"

namespace burin {
namespace {

// Derivatives in the order of the table's columns, with the part of the name after "dDhat_d" or "darea_d".
constexpr std::array<const char*, 15> kDerivatives = {"hx", "hy", "hz", "alpha", "width_um", "depth_um", "L_mm", "x0",
                                                      "y0", "x1", "y1", "x2",    "y2",       "x3",       "y3"};
constexpr int kFirstAreaDerivative = 4;  // the area does not depend on h and alpha

/// A row's numbers by column name.
class Row {
 public:
  explicit Row(const TableReader& table) : table_(table) {}

  bool has(const std::string& column) const { return table_.find(column).has_value(); }
  std::string text(const std::string& column) const { return std::string(table_.text(at(column))); }
  double number(const std::string& column) const { return table_.number(at(column)); }
  double positive(const std::string& column) const { return table_.positive(at(column)); }
  std::string where() const { return table_.where(); }

 private:
  std::size_t at(const std::string& column) const { return *table_.find(column); }

  const TableReader& table_;
};

// Derivatives of a gradient by index into kDerivatives, so reading, comparison and printing are loops.
double derivative(const FootprintGradient& g, int i, bool of_area) {
  switch (i) {
    case 0:
    case 1:
    case 2:
      return of_area ? 0 : g.dDhat_dhalf[i];
    case 3:
      return of_area ? 0 : g.dDhat_dalpha;
    case 4:
      return of_area ? g.darea_dwidth_um : g.dDhat_dwidth_um;
    case 5:
      return of_area ? g.darea_ddepth_um : g.dDhat_ddepth_um;
    case 6:
      return of_area ? g.darea_dlength_mm : g.dDhat_dlength_mm;
    default:
      return (of_area ? g.darea_dcorner : g.dDhat_dcorner)[(i - 7) / 2][(i - 7) % 2];
  }
}

void set_derivative(FootprintGradient& g, int i, bool of_area, double value) {
  switch (i) {
    case 0:
    case 1:
    case 2:
      g.dDhat_dhalf[i] = value;
      break;
    case 3:
      g.dDhat_dalpha = value;
      break;
    case 4:
      (of_area ? g.darea_dwidth_um : g.dDhat_dwidth_um) = value;
      break;
    case 5:
      (of_area ? g.darea_ddepth_um : g.dDhat_ddepth_um) = value;
      break;
    case 6:
      (of_area ? g.darea_dlength_mm : g.dDhat_dlength_mm) = value;
      break;
    default:
      (of_area ? g.darea_dcorner : g.dDhat_dcorner)[(i - 7) / 2][(i - 7) % 2] = value;
  }
}

std::string derivative_column(int i, bool of_area) {
  return (of_area ? "darea_d" : "dDhat_d") + std::string(kDerivatives[i]);
}

std::optional<FootprintGradient> read_gradient(const Row& row, bool of_area) {
  FootprintGradient g;
  g.dDhat_dcorner.fill(Eigen::Vector2d::Zero());
  g.darea_dcorner.fill(Eigen::Vector2d::Zero());
  const int first = of_area ? kFirstAreaDerivative : 0;
  for (int i = first; i < int(kDerivatives.size()); ++i) {
    if (!row.has(derivative_column(i, of_area))) return std::nullopt;
    set_derivative(g, i, of_area, row.number(derivative_column(i, of_area)));
  }
  return g;
}

NdfCase read_case(const Row& row, std::size_t index) {
  NdfCase c;
  c.id = row.has("id") ? row.text("id") : std::to_string(index);
  if (row.has("kind")) c.kind = row.text("kind");
  c.h_scratch = {row.number("hx"), row.number("hy"), row.number("hz")};
  if (!(c.h_scratch.norm() > 0))
    fail(row.where() + ": hx, hy, hz", "the half vector has no length", "give a direction");
  c.groove = {row.positive("width_um"), row.positive("depth_um"), row.positive("alpha"), row.positive("L_mm")};
  if (c.groove.alpha > 1)
    fail(row.where() + ": alpha", "is " + row.text("alpha") + ", expected at most 1", "correct this row");
  for (int i = 0; i < 4; ++i) {
    const std::string n = std::to_string(i);
    c.corners_mm[i] = {row.number("x" + n + "_mm"), row.number("y" + n + "_mm")};
  }
  c.Dhat_mm2 = row.number("Dhat_mm2");
  if (row.has("area_mm2")) c.area_mm2 = row.number("area_mm2");
  c.Dhat_gradient = read_gradient(row, false);
  c.area_gradient = read_gradient(row, true);
  return c;
}

// Worst difference of two gradients over the largest derivative of `expected`. Sets `worst` to the name of its column.
double gradient_error(const FootprintGradient& computed, const FootprintGradient& expected, const Eigen::Vector3d& h,
                      bool of_area, std::string& worst) {
  const auto tangential = [&](const Eigen::Vector3d& g) -> Eigen::Vector3d { return g - g.dot(h) * h; };
  FootprintGradient a = computed, b = expected;
  a.dDhat_dhalf = tangential(a.dDhat_dhalf);
  b.dDhat_dhalf = tangential(b.dDhat_dhalf);
  double largest = 0, difference = 0;
  for (int i = of_area ? kFirstAreaDerivative : 0; i < int(kDerivatives.size()); ++i) {
    const double got = derivative(a, i, of_area), want = derivative(b, i, of_area);
    largest = std::max(largest, std::abs(want));
    if (!(std::abs(got - want) <= difference)) {
      difference = std::abs(got - want);
      worst = derivative_column(i, of_area);
    }
  }
  if (difference == 0) return 0;
  return largest > 0 ? difference / largest : std::numeric_limits<double>::infinity();
}

double diameter_mm(const Quad& corners_mm) {
  double d = 0;
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < i; ++j) d = std::max(d, (corners_mm[i] - corners_mm[j]).norm());
  }
  return d;
}

std::string formatted(const char* format, auto... values) {
  std::array<char, 512> text;
  std::snprintf(text.data(), text.size(), format, values...);
  return text.data();
}

}  // namespace

std::vector<NdfCase> read_ndf_cases(const std::filesystem::path& file) {
  TableReader table(file, TableStyle::csv,
                    {"hx", "hy", "hz", "alpha", "width_um", "depth_um", "L_mm", "x0_mm", "y0_mm", "x1_mm", "y1_mm",
                     "x2_mm", "y2_mm", "x3_mm", "y3_mm", "Dhat_mm2"},
                    "add it to the header");
  std::vector<NdfCase> cases;
  while (table.next()) cases.push_back(read_case(Row(table), cases.size()));
  if (cases.empty()) fail(file.string(), "has no rows", "give a header line and at least one case");
  return cases;
}

NdfComparison compare(const NdfCase& c) {
  NdfComparison r;
  r.id = c.id;
  r.kind = c.kind;
  r.computed = footprint_integral_gradient(c.groove, c.corners_mm, c.h_scratch);
  r.expected_Dhat_mm2 = c.Dhat_mm2;
  r.error_mm2 = r.computed.value.Dhat_mm2 - c.Dhat_mm2;
  const double error = std::abs(r.error_mm2);
  const double infinity = std::numeric_limits<double>::infinity();
  r.relative_error = error == 0 ? 0 : c.Dhat_mm2 == 0 ? infinity : error / std::abs(c.Dhat_mm2);
  const double floor_mm2 = 1e-14 * std::pow(diameter_mm(c.corners_mm), 2);
  r.tolerance_mm2 =
      std::max(1e-9 * std::abs(c.Dhat_mm2), floor_mm2 / (std::numbers::pi * c.groove.alpha * c.groove.alpha));
  r.value_ok = error <= r.tolerance_mm2;
  if (c.area_mm2) {
    r.area_error_mm2 = r.computed.value.area_mm2 - *c.area_mm2;
    r.area_ok = std::abs(*r.area_error_mm2) <= std::max(1e-9 * *c.area_mm2, floor_mm2);
  }
  const Eigen::Vector3d h = c.h_scratch.stableNormalized();
  if (c.Dhat_gradient) {
    r.gradient_error = gradient_error(r.computed, *c.Dhat_gradient, h, false, r.worst_derivative);
    r.gradient_ok = *r.gradient_error <= 1e-8;
  }
  if (c.area_gradient) {
    std::string worst;
    r.area_gradient_error = gradient_error(r.computed, *c.area_gradient, h, true, worst);
    r.gradient_ok = r.gradient_ok && *r.area_gradient_error <= 1e-8;
    if (!r.gradient_error || *r.area_gradient_error > *r.gradient_error) r.worst_derivative = worst;
  }
  return r;
}

std::string ndf_table_header() {
  return formatted("%-6s %-16s %24s %24s %10s %10s %10s  %s", "id", "kind", "Dhat_mm2", "expected", "relative",
                   "/tolerance", "gradient", "verdict");
}

std::string ndf_line(const NdfComparison& c) {
  std::string verdict = c.value_ok ? "" : " VALUE";
  if (!c.area_ok) verdict += " AREA";
  if (!c.gradient_ok) verdict += " GRADIENT(" + c.worst_derivative + ")";
  if (c.ok()) verdict = " ok";
  std::string gradient = "-";
  if (c.gradient_error || c.area_gradient_error) {
    gradient = formatted("%.1e", std::max(c.gradient_error.value_or(0), c.area_gradient_error.value_or(0)));
  }
  return formatted("%-6s %-16s %24.16e %24.16e %10.1e %10.1e %10s ", c.id.c_str(), c.kind.c_str(),
                   c.computed.value.Dhat_mm2, c.expected_Dhat_mm2, c.relative_error,
                   c.tolerance_mm2 > 0 ? std::abs(c.error_mm2) / c.tolerance_mm2 : 0.0, gradient.c_str()) +
         verdict;
}

std::string ndf_gradient_line(const NdfComparison& c) {
  std::string line;
  for (int i = 0; i < int(kDerivatives.size()); ++i) {
    line += (i ? " " : "       ") + derivative_column(i, false) +
            formatted("=%.9e", derivative(c.computed, i, false) + 0.0);
  }
  return line;
}

std::string ndf_summary(const std::vector<NdfComparison>& rows) {
  std::size_t passed = 0;
  const NdfComparison *value = nullptr, *gradient = nullptr;
  for (const auto& r : rows) {
    passed += r.ok();
    const auto over = [](const NdfComparison& c) { return std::abs(c.error_mm2) / c.tolerance_mm2; };
    if (r.tolerance_mm2 > 0 && (!value || over(r) > over(*value))) value = &r;
    if (r.gradient_error && (!gradient || *r.gradient_error > *gradient->gradient_error)) gradient = &r;
  }
  std::string text = formatted("%zu rows, %zu within tolerance", rows.size(), passed);
  if (value) {
    text += formatted("; worst value error %.1e of its tolerance (row %s)",
                      std::abs(value->error_mm2) / value->tolerance_mm2, value->id.c_str());
  }
  if (gradient) {
    text += formatted("; worst gradient error %.1e of the row's largest (row %s, %s)", *gradient->gradient_error,
                      gradient->id.c_str(), gradient->worst_derivative.c_str());
  }
  return text;
}

}  // namespace burin
