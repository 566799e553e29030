#include "burin/render/files/table.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <system_error>
#include <utility>

#include "burin/render/error.h"
#include "burin/render/files/input_file.h"
#include "burin/render/limits.h"

namespace burin {
namespace {

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t\r");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

}  // namespace

std::optional<double> number_in(std::string_view text) {
  if (text.starts_with('+')) text.remove_prefix(1);  // from_chars knows no plus sign
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (end != text.data() + text.size()) return std::nullopt;
  if (error == std::errc::result_out_of_range && text.find("e-") != std::string_view::npos) return 0.0;
  if (error != std::errc() || !std::isfinite(value)) return std::nullopt;
  return value;
}

TableReader::TableReader(std::filesystem::path file, TableStyle style, std::vector<std::string> required,
                         std::string remedy)
    : file_(std::move(file)),
      style_(style),
      required_(std::move(required)),
      remedy_(std::move(remedy)),
      content_(read_bytes(file_, limit::kTableBytes, "a table")),
      rest_(content_) {
  if (rest_.starts_with("\xEF\xBB\xBF")) rest_.remove_prefix(3);  // the mark that some spreadsheets put first
  if (style_ == TableStyle::csv) read_csv_header();
}

std::string_view TableReader::next_line() {
  const std::size_t end = rest_.find('\n');
  const std::string_view line = rest_.substr(0, end);
  rest_ = end == std::string_view::npos ? std::string_view{} : rest_.substr(end + 1);
  ++line_;
  return trimmed(line);
}

void TableReader::read_csv_header() {
  std::string_view header;
  while (!rest_.empty() && header.empty()) header = next_line();
  if (header.empty()) return;
  split_csv(header);
  if (values_.size() > limit::kColumns)
    fail(where(), "names more than " + with_commas(limit::kColumns) + " columns", remedy_);
  for (const std::string_view name : values_) {
    if (find(name)) fail(where(), "column " + std::string(name) + " appears twice", "keep one of them");
    columns_.emplace_back(name);
  }
  for (const std::string& name : required_)
    if (!find(name)) fail(where(), "column " + name + " is missing", remedy_);
}

std::optional<std::size_t> TableReader::find(std::string_view column) const {
  const auto at = std::find(columns_.begin(), columns_.end(), column);
  if (at == columns_.end()) return std::nullopt;
  return static_cast<std::size_t>(at - columns_.begin());
}

void TableReader::split_csv(std::string_view line) {
  values_.clear();
  for (;;) {
    const std::size_t comma = line.find(',');
    values_.push_back(trimmed(line.substr(0, comma)));
    if (comma == std::string_view::npos || values_.size() > limit::kColumns) return;
    line.remove_prefix(comma + 1);
  }
}

void TableReader::split_words(std::string_view line) {
  values_.clear();
  for (line = trimmed(line); !line.empty(); line = trimmed(line)) {
    if (values_.size() > limit::kColumns) return;
    const std::size_t end = std::min(line.find_first_of(" \t"), line.size());
    values_.push_back(line.substr(0, end));
    line.remove_prefix(end);
  }
}

void TableReader::count_row() {
  if (rows_++ == limit::kScratches)
    fail(where(), "is one row more than the " + with_commas(limit::kScratches) + " that Burin takes of a table",
         "split the table, or thin it out (docs/limits.md)");
}

bool TableReader::next() {
  while (!rest_.empty()) {
    const std::string_view line = next_line();
    if (line.empty()) continue;
    if (style_ == TableStyle::csv) {
      split_csv(line);
      count_row();
      const std::string columns = std::to_string(columns_.size());
      if (values_.size() < columns_.size())
        fail(where(), "has " + std::to_string(values_.size()) + " values, the first line names " + columns + " columns",
             "write one for each column of the first line");
      if (values_.size() > columns_.size())
        fail(where(), "has more than " + columns + " values", "write one for each column of the first line");
      return true;
    }
    if (line.starts_with('#')) {
      if (!columns_.empty() || line.starts_with("##") || line.starts_with("#!")) continue;
      split_words(line.substr(1));
      const auto named = [&](const std::string& name) {
        return std::find(values_.begin(), values_.end(), name) != values_.end();
      };
      if (std::all_of(required_.begin(), required_.end(), named)) columns_.assign(values_.begin(), values_.end());
      continue;
    }
    if (columns_.empty()) {
      std::string names;
      for (const std::string& name : required_) names += (names.empty() ? "" : ", ") + name;
      fail(where(), "no line above it names the columns " + names, remedy_);
    }
    split_words(line);
    return true;
  }
  return false;
}

std::string TableReader::where() const { return file_.string() + ":" + std::to_string(line_); }

std::size_t TableReader::rows_left() const {
  return std::min(static_cast<std::size_t>(std::count(rest_.begin(), rest_.end(), '\n')) + 1, limit::kScratches);
}

std::string_view TableReader::text(std::size_t column) const {
  if (column >= values_.size()) fail(where(), "is cut short: " + columns_[column] + " is missing", "write it again");
  return values_[column];
}

double TableReader::number(std::size_t column) const {
  const std::optional<double> value = number_in(text(column));
  if (!value)
    fail_at(column, "is \"" + std::string(text(column).substr(0, 40)) + "\"",
            "write a finite number with a decimal point");
  return *value;
}

int TableReader::whole(std::size_t column) const {
  const double value = number(column);
  if (value != std::floor(value) || std::abs(value) > std::numeric_limits<int>::max())
    fail_at(column, "is " + std::string(text(column).substr(0, 40)), "write a whole number of at most 9 digits");
  return static_cast<int>(value);
}

double TableReader::positive(std::size_t column) const {
  const double value = number(column);
  if (!(value > 0)) fail_at(column, "is " + std::string(text(column)), "write a number greater than 0");
  return value;
}

void TableReader::fail_at(std::size_t column, const std::string& what, const std::string& remedy) const {
  fail(where(), columns_[column] + " " + what, remedy);
}

}  // namespace burin
