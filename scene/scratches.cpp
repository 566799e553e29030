#include "burin/scene/scratches.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <string>

#include "burin/base/error.h"
#include "burin/base/files/decimals.h"
#include "burin/base/files/json_file.h"
#include "burin/base/files/table.h"
#include "burin/scene/physical_bounds.h"

namespace burin {
namespace {

constexpr double kShortest_mm = 1e-6;  // a nanometer: a shorter scratch has no direction

struct Column {
  const char* name;
  std::vector<double> Scratches::*values;
  bool required, positive;
  double most;
  double least = 0;  // smallest distance from 0
};
constexpr std::array<Column, 8> kColumns{
    {{"x0_mm", &Scratches::x0_mm, true, false, bound::kPlace_mm},
     {"y0_mm", &Scratches::y0_mm, true, false, bound::kPlace_mm},
     {"x1_mm", &Scratches::x1_mm, true, false, bound::kPlace_mm},
     {"y1_mm", &Scratches::y1_mm, true, false, bound::kPlace_mm},
     {"width_um", &Scratches::width_um, false, true, bound::kToolWidth_um},
     {"depth_um", &Scratches::depth_um, false, true, bound::kDepth_um, bound::kShallowest_um},
     {"alpha", &Scratches::alpha, false, true, 1e9},
     {"carved", &Scratches::carved, false, false, 1e9}}};

/// All columns, including the one outside files.
constexpr std::array<std::vector<double> Scratches::*, kColumns.size() + 1> all_columns() {
  std::array<std::vector<double> Scratches::*, kColumns.size() + 1> out{};
  for (std::size_t i = 0; i < kColumns.size(); ++i) out[i] = kColumns[i].values;
  out.back() = &Scratches::left;
  return out;
}
constexpr auto kAllColumns = all_columns();

/// The columns of the table, in its order.
std::vector<const Column*> columns_of(const TableReader& table) {
  constexpr const char* kRemedy =
      "the first line must be x0_mm,y0_mm,x1_mm,y1_mm and, if they vary, width_um,depth_um,alpha,carved";
  std::vector<const Column*> columns;
  for (const std::string& name : table.columns()) {
    const auto* const column =
        std::find_if(kColumns.begin(), kColumns.end(), [&](const Column& c) { return name == c.name; });
    if (column == kColumns.end()) fail(table.where(), "unknown column \"" + name + "\"", kRemedy);
    columns.push_back(column);
  }
  for (const Column& column : kColumns)
    if (column.required && std::find(columns.begin(), columns.end(), &column) == columns.end())
      fail(table.where(), std::string("column ") + column.name + " is missing", kRemedy);
  return columns;
}

/// Fixed decimals for places, significant digits for other values; independent of the locale.
void append_number(std::string& text, double value, bool place) {
  std::array<char, 64> buffer;
  const auto result = place ? std::to_chars(buffer.begin(), buffer.end(), value, std::chars_format::fixed, 5)
                            : std::to_chars(buffer.begin(), buffer.end(), value, std::chars_format::general, 9);
  text.append(buffer.data(), result.ptr);
}

}  // namespace

Scratches read_scratches(const std::filesystem::path& file) {
  TableReader table(file, TableStyle::csv, {}, {});
  const std::vector<const Column*> columns = columns_of(table);
  Scratches scratches;
  for (const Column* column : columns) (scratches.*column->values).reserve(table.rows_left());
  while (table.next()) {
    for (std::size_t c = 0; c < columns.size(); ++c)
      (scratches.*columns[c]->values).push_back(columns[c]->positive ? table.positive(c) : table.number(c));
    if (!scratches.carved.empty() && scratches.carved.back() != 0 && scratches.carved.back() != 1)
      fail(table.where(), "carved is neither 0 nor 1", "write 1 for what is carved already, 0 for the rest");
    for (std::size_t c = 0; c < columns.size(); ++c) {
      const double size = std::abs((scratches.*columns[c]->values).back());
      if (size > columns[c]->most || size < columns[c]->least)
        table.fail_at(c, "is " + std::string(table.text(c).substr(0, 40)) + ", beyond what any board holds",
                      "write " + (columns[c]->least > 0 ? shortest(columns[c]->least) + " to " : "at most ") +
                          shortest(columns[c]->most) + ", and check its unit");
    }
    if (!scratches.alpha.empty() && scratches.alpha.back() > 1)
      fail(table.where(), "alpha is greater than 1", "write a roughness above 0 and up to 1");
    if (std::hypot(scratches.x1_mm.back() - scratches.x0_mm.back(), scratches.y1_mm.back() - scratches.y0_mm.back()) <
        kShortest_mm)
      fail(table.where(), "the scratch has no length: both ends are the same", "remove the line or correct an end");
  }
  return scratches;
}

void write_scratches(const Scratches& scratches, const std::filesystem::path& file) {
  const std::size_t count = scratches.size();
  std::vector<const Column*> columns;
  for (const Column& column : kColumns) {
    const std::vector<double>& values = scratches.*column.values;
    if (values.size() != count && (column.required || !values.empty()))
      fail(file.string(),
           std::string(column.name) + " has " + std::to_string(values.size()) + " values for " + std::to_string(count) +
               " scratches",
           "give one each");
    if (column.required || !values.empty()) columns.push_back(&column);
  }
  std::string text;
  text.reserve(64 + count * 12 * columns.size());
  for (const Column* column : columns) text += (column == columns.front() ? "" : ",") + std::string(column->name);
  text += '\n';
  for (std::size_t i = 0; i < count; ++i) {
    for (const Column* column : columns) {
      const double value = (scratches.*column->values)[i];
      if (!std::isfinite(value) || std::abs(value) > 1e9)
        fail(file.string(), std::string(column->name) + " of scratch " + std::to_string(i) + " is not a usable number",
             "this is a fault of the calculation before");
      if (column != columns.front()) text += ',';
      append_number(text, value, column->required);
    }
    text += '\n';
  }
  write_text(text, file);
}

Scratches selected(const Scratches& scratches, std::span<const std::size_t> rows) {
  Scratches out;
  for (const auto column : kAllColumns) {
    const std::vector<double>& from = scratches.*column;
    if (from.empty()) continue;
    std::vector<double>& to = out.*column;
    to.reserve(rows.size());
    for (const std::size_t row : rows) to.push_back(from[row]);
  }
  return out;
}

Scratches joined(const Scratches& first, const Scratches& second, double width_um, double depth_um, double alpha) {
  Scratches out = first;
  const auto shared = [&](std::vector<double> Scratches::*column) {
    if (column == &Scratches::width_um) return width_um;
    if (column == &Scratches::depth_um) return depth_um;
    if (column == &Scratches::left) return 1.0;
    return column == &Scratches::alpha ? alpha : 0.0;
  };
  for (const auto column : kAllColumns) {
    std::vector<double>& to = out.*column;
    const std::vector<double>& more = second.*column;
    if (to.empty() && more.empty()) continue;
    if (to.empty()) to.assign(first.size(), shared(column));
    to.insert(to.end(), more.begin(), more.end());
    to.resize(first.size() + second.size(), shared(column));
  }
  return out;
}

}  // namespace burin
