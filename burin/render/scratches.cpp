#include "burin/render/scratches.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <string>
#include <string_view>
#include <system_error>

#include "burin/render/error.h"
#include "burin/render/files/json_file.h"

namespace burin {
namespace {

namespace fs = std::filesystem;

constexpr double kShortest_mm = 1e-6;  // a nanometre: below it a scratch has no direction

struct Column {
  const char* name;
  std::vector<double> Scratches::*values;
  bool required, positive;
};
constexpr std::array<Column, 8> kColumns{{{"x0_mm", &Scratches::x0_mm, true, false},
                                          {"y0_mm", &Scratches::y0_mm, true, false},
                                          {"x1_mm", &Scratches::x1_mm, true, false},
                                          {"y1_mm", &Scratches::y1_mm, true, false},
                                          {"width_um", &Scratches::width_um, false, true},
                                          {"depth_um", &Scratches::depth_um, false, true},
                                          {"alpha", &Scratches::alpha, false, true},
                                          {"carved", &Scratches::carved, false, false}}};

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t\r");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

/// Cuts the next line (without its end) off the front of `rest`.
std::string_view next_line(std::string_view& rest) {
  const std::size_t end = rest.find('\n');
  const std::string_view line = rest.substr(0, end);
  rest = end == std::string_view::npos ? std::string_view{} : rest.substr(end + 1);
  return line;
}

/// Cuts the next value off the front of a row; `more` says whether a comma followed it.
std::string_view next_value(std::string_view& row, bool& more) {
  const std::size_t end = row.find(',');
  more = end != std::string_view::npos;
  const std::string_view value = trimmed(row.substr(0, end));
  row = more ? row.substr(end + 1) : std::string_view{};
  return value;
}

std::string at_line(const fs::path& file, std::size_t line) { return file.string() + ":" + std::to_string(line); }

std::vector<const Column*> read_header(const fs::path& file, std::string_view header) {
  constexpr const char* kRemedy =
      "the first line must be x0_mm,y0_mm,x1_mm,y1_mm and, if they vary, width_um,depth_um,alpha,carved";
  std::vector<const Column*> columns;
  bool more = !trimmed(header).empty();
  while (more) {
    const std::string_view name = next_value(header, more);
    const auto* const column =
        std::find_if(kColumns.begin(), kColumns.end(), [&](const Column& c) { return name == c.name; });
    if (column == kColumns.end()) fail(at_line(file, 1), "unknown column \"" + std::string(name) + "\"", kRemedy);
    if (std::find(columns.begin(), columns.end(), column) != columns.end())
      fail(at_line(file, 1), "column " + std::string(name) + " appears twice", "keep one of them");
    columns.push_back(column);
  }
  for (const Column& column : kColumns)
    if (column.required && std::find(columns.begin(), columns.end(), &column) == columns.end())
      fail(at_line(file, 1), std::string("column ") + column.name + " is missing", kRemedy);
  return columns;
}

/// Fixed decimals for places, significant digits for the rest; no locale.
void append_number(std::string& text, double value, bool place) {
  std::array<char, 64> buffer;
  const auto result = place ? std::to_chars(buffer.begin(), buffer.end(), value, std::chars_format::fixed, 5)
                            : std::to_chars(buffer.begin(), buffer.end(), value, std::chars_format::general, 9);
  text.append(buffer.data(), result.ptr);
}

}  // namespace

Scratches read_scratches(const std::filesystem::path& file) {
  const std::string text = read_text(file);
  std::string_view rest = text;
  if (rest.starts_with("\xEF\xBB\xBF")) rest.remove_prefix(3);  // the mark that some spreadsheets put first
  const std::vector<const Column*> columns = read_header(file, next_line(rest));

  Scratches scratches;
  const std::size_t rows = static_cast<std::size_t>(std::count(rest.begin(), rest.end(), '\n')) + 1;
  for (const Column* column : columns) (scratches.*column->values).reserve(rows);
  for (std::size_t line_number = 2; !rest.empty(); ++line_number) {
    std::string_view row = next_line(rest);
    if (trimmed(row).empty()) continue;
    bool more = true;
    for (std::size_t c = 0; c < columns.size(); ++c) {
      if (!more)
        fail(at_line(file, line_number), "has " + std::to_string(c) + " values",
             "write " + std::to_string(columns.size()) + ", one for each column of the first line");
      const Column& column = *columns[c];
      std::string_view field = next_value(row, more);
      if (field.starts_with('+')) field.remove_prefix(1);  // from_chars knows no plus sign
      double value = 0;
      const auto result = std::from_chars(field.data(), field.data() + field.size(), value);
      if (result.ec != std::errc{} || result.ptr != field.data() + field.size() || !std::isfinite(value))
        fail(at_line(file, line_number), std::string(column.name) + " is \"" + std::string(field.substr(0, 40)) + "\"",
             "write a finite number with a decimal point");
      if (column.positive && !(value > 0))
        fail(at_line(file, line_number), std::string(column.name) + " is " + std::string(field),
             "write a number greater than 0");
      (scratches.*column.values).push_back(value);
    }
    if (more)
      fail(at_line(file, line_number), "has more than " + std::to_string(columns.size()) + " values",
           "write one for each column of the first line");
    if (!scratches.carved.empty() && scratches.carved.back() != 0 && scratches.carved.back() != 1)
      fail(at_line(file, line_number), "carved is neither 0 nor 1",
           "write 1 for what is carved already, 0 for the rest");
    if (!scratches.alpha.empty() && scratches.alpha.back() > 1)
      fail(at_line(file, line_number), "alpha is greater than 1", "write a roughness above 0 and up to 1");
    if (std::hypot(scratches.x1_mm.back() - scratches.x0_mm.back(), scratches.y1_mm.back() - scratches.y0_mm.back()) <
        kShortest_mm)
      fail(at_line(file, line_number), "the scratch has no length: both ends are the same",
           "remove the line or correct an end");
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
  for (const Column& column : kColumns) {
    const std::vector<double>& from = scratches.*column.values;
    if (from.empty()) continue;
    std::vector<double>& to = out.*column.values;
    to.reserve(rows.size());
    for (const std::size_t row : rows) to.push_back(from[row]);
  }
  return out;
}

Scratches joined(const Scratches& first, const Scratches& second, double width_um, double depth_um, double alpha) {
  Scratches out = first;
  const auto shared = [&](const Column& column) {
    if (column.values == &Scratches::width_um) return width_um;
    if (column.values == &Scratches::depth_um) return depth_um;
    return column.values == &Scratches::alpha ? alpha : 0.0;
  };
  for (const Column& column : kColumns) {
    std::vector<double>& to = out.*column.values;
    const std::vector<double>& more = second.*column.values;
    if (to.empty() && more.empty()) continue;
    if (to.empty()) to.assign(first.size(), shared(column));
    to.insert(to.end(), more.begin(), more.end());
    to.resize(first.size() + second.size(), shared(column));
  }
  return out;
}

}  // namespace burin
