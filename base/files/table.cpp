#include "burin/base/files/table.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <system_error>
#include <utility>

#include "burin/base/error.h"
#include "burin/base/files/input_file.h"
#include "burin/base/input_error.h"
#include "burin/base/limits.h"

namespace burin {
namespace {

std::string_view trimmed(std::string_view text, std::string_view blanks = " \t\r") {
  const std::size_t first = text.find_first_not_of(blanks);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(blanks) - first + 1);
}

// A spreadsheet's separator, from the line that names the columns: names never contain one.
char separator_of(std::string_view header) {
  for (const char c : {';', '\t'})
    if (header.find(c) != std::string_view::npos) return c;
  return ',';
}

}  // namespace

std::optional<double> number_in(std::string_view text) {
  if (text.starts_with('+')) text.remove_prefix(1);  // from_chars rejects a plus sign
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
  fail_unless_text();
  if (rest_.starts_with("\xEF\xBB\xBF")) rest_.remove_prefix(3);  // the byte order mark of some spreadsheets
  if (style_ == TableStyle::csv) read_csv_header();
}

// A spreadsheet file itself, or its "Unicode text", with a table's name.
void TableReader::fail_unless_text() const {
  const auto begins = [&](std::string_view bytes) { return rest_.starts_with(bytes); };
  if (begins("\xFF\xFE") || begins("\xFE\xFF"))
    fail_as(ErrorCode::bad_table, file_.string(), "is text in UTF-16", "save it as \"CSV UTF-8\"");
  if (begins("PK\x03\x04") || begins("\xD0\xCF\x11\xE0"))
    fail_as(ErrorCode::bad_table, file_.string(), "is a spreadsheet, not a table of text",
            "export it as CSV in its program");
}

std::string_view TableReader::next_line() {
  const std::size_t end = rest_.find_first_of("\r\n");  // of Windows, Unix, and old Macs
  const std::string_view line = rest_.substr(0, end);
  rest_.remove_prefix(std::min(end, rest_.size()));
  rest_.remove_prefix(rest_.starts_with("\r\n") ? 2 : std::min<std::size_t>(1, rest_.size()));
  ++line_;
  return trimmed(line, separator_ == '\t' ? " \r" : " \t\r");
}

void TableReader::read_csv_header() {
  std::string_view header;
  while (!rest_.empty() && header.empty()) header = next_line();
  if (header.empty()) return;
  bool told = false;  // set by Excel's first line, sep=;
  if (const std::string_view bare = trimmed(header, "\""); bare.starts_with("sep=") && bare.size() == 5) {
    separator_ = bare.back();
    if (separator_ != ',' && separator_ != ';' && separator_ != '\t')
      fail_as(ErrorCode::bad_table, where(), std::string("separates by \"") + separator_ + "\"",
              "separate by commas, semicolons or tabs");
    told = true;
    header = {};
    while (!rest_.empty() && header.empty()) header = next_line();
  } else if (header == "sep=") {  // a tab, which looks like a blank
    separator_ = '\t', told = true;
    header = next_line();
  }
  if (!told) separator_ = separator_of(header);
  split_csv(header);
  if (values_.size() > limit::kColumns)
    fail_as(ErrorCode::bad_table, where(), "names more than " + with_commas(limit::kColumns) + " columns", remedy_);
  while (!values_.empty() && values_.back().empty()) values_.pop_back();
  for (const std::string_view name : values_) {
    if (name.empty())
      fail_as(ErrorCode::bad_table, where(), "column " + std::to_string(columns_.size() + 1) + " has no name",
              "name it, or remove it");
    if (find(name))
      fail_as(ErrorCode::bad_table, where(), "column " + std::string(name) + " appears twice", "keep one of them");
    columns_.emplace_back(name);
  }
  for (const std::string& name : required_)
    if (!find(name)) fail_as(ErrorCode::bad_table, where(), "column " + name + " is missing", remedy_);
}

std::optional<std::size_t> TableReader::find(std::string_view column) const {
  const auto at = std::find(columns_.begin(), columns_.end(), column);
  if (at == columns_.end()) return std::nullopt;
  return static_cast<std::size_t>(at - columns_.begin());
}

// Removes and returns the quoted value at the front of a line.
std::string_view TableReader::quoted(std::string_view& line) {
  const std::size_t end = line.find('"', 1);
  if (end == std::string_view::npos)
    fail_as(ErrorCode::bad_table, where(), "value " + std::to_string(values_.size() + 1) + " has no closing quote",
            "add \" behind it");
  const std::string_view value = line.substr(1, end - 1);
  line.remove_prefix(end + 1);
  line.remove_prefix(std::min(line.find_first_not_of(separator_ == '\t' ? " \r" : " \t\r"), line.size()));
  if (!line.empty() && line.front() != separator_)
    fail_as(ErrorCode::bad_table, where(), "value " + std::to_string(values_.size() + 1) + " goes on behind its quotes",
            std::string("put \"") + separator_ + "\" behind it");
  return value;
}

void TableReader::split_csv(std::string_view line) {
  values_.clear();
  in_quotes_.clear();
  for (;;) {
    line.remove_prefix(std::min(line.find_first_not_of(' '), line.size()));
    const bool in_quotes = line.starts_with('"');
    in_quotes_.push_back(in_quotes);
    values_.push_back(trimmed(in_quotes ? quoted(line) : line.substr(0, line.find(separator_))));
    const std::size_t end = line.find(separator_);
    if (end == std::string_view::npos || values_.size() > limit::kColumns) return;
    line.remove_prefix(end + 1);
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
    fail_as(ErrorCode::bad_table, where(),
            "is one row more than the " + with_commas(limit::kScratches) + " that Burin takes of a table",
            "split the table, or thin it out (docs/limits.md)");
}

bool TableReader::next() {
  while (!rest_.empty()) {
    const std::string_view line = next_line();
    if (line.empty()) continue;
    if (style_ == TableStyle::csv) {
      split_csv(line);
      const auto empty = [](std::string_view value) { return value.empty(); };
      if (std::all_of(values_.begin(), values_.end(), empty)) continue;
      while (values_.size() > columns_.size() && values_.back().empty()) values_.pop_back();
      count_row();
      const std::string columns = std::to_string(columns_.size());
      if (values_.size() < columns_.size())
        fail_as(ErrorCode::bad_table, where(),
                "has " + std::to_string(values_.size()) + " values, the first line names " + columns + " columns",
                "write one for each column of the first line");
      if (values_.size() > columns_.size())
        fail_as(ErrorCode::bad_table, where(), "has more than " + columns + " values",
                "write one for each column of the first line" +
                    std::string(separator_ == ',' ? " (with decimal commas, separate values by semicolons)" : ""));
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
      fail_as(ErrorCode::bad_table, where(), "no line above it names the columns " + names, remedy_);
    }
    split_words(line);
    return true;
  }
  return false;
}

std::string TableReader::where() const { return file_.string() + ":" + std::to_string(line_); }

std::size_t TableReader::rows_left() const {
  const auto ends =
      std::max(std::count(rest_.begin(), rest_.end(), '\n'), std::count(rest_.begin(), rest_.end(), '\r'));
  return std::min(static_cast<std::size_t>(ends) + 1, limit::kScratches);
}

std::string_view TableReader::text(std::size_t column) const {
  if (column >= values_.size())
    fail_as(ErrorCode::bad_table, where(), "is cut short: " + columns_[column] + " is missing", "write it again");
  return values_[column];
}

// The number of a value, whose comma may be a decimal mark.
std::optional<double> TableReader::number_or_none(std::size_t column) const {
  if (style_ != TableStyle::csv || (separator_ == ',' && !in_quotes_[column])) return number_in(text(column));
  std::string value(text(column));
  const std::size_t comma = value.find(','), mark = value.find_first_of(".,");
  if (mark == std::string::npos) return number_in(value);
  if (comma != std::string::npos && value.find_first_of(".,", mark + 1) != std::string::npos) return std::nullopt;
  if (decimal_mark_ == 0) decimal_mark_ = value[mark];
  const std::string as_text = "is \"" + value.substr(0, 40) + "\"";
  if (value[mark] != decimal_mark_)
    fail_at(column, as_text + ", and above it decimals stand behind a " + (decimal_mark_ == ',' ? "comma" : "point"),
            "write decimal points in the whole file, and no marks between thousands");
  if (comma == std::string::npos) return number_in(value);
  // In a comma-separated file, a program with decimal points may have used the comma as a thousands separator.
  if (separator_ == ',' && value.size() - comma == 4)
    fail_at(column, as_text + ", which may be a decimal comma or one between thousands", "write decimal points");
  value[comma] = '.';
  return number_in(value);
}

double TableReader::number(std::size_t column) const {
  const std::optional<double> value = number_or_none(column);
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
  fail_as(ErrorCode::bad_table, where(), columns_[column] + " " + what, remedy);
}

}  // namespace burin
