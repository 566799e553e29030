// burin/base/files/table.h - tables of text, a row a line, columns by name: CSV (scratches, footprint integrals) and
// vnlog (residuals, chessboards' corners). docs/file-formats.md.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace burin {

/// A finite number with a decimal point, whatever the locale; a plus sign may stand before it, and what is too small
/// for a double is 0. Nothing for any other text.
std::optional<double> number_in(std::string_view text);

enum class TableStyle {
  csv,   ///< values between commas, or as a spreadsheet writes them (below); the first line names the columns; every
         ///< row has a value for each
  vnlog  ///< words; the first line of the form "# name name ..." that has all required columns names them; further
         ///< lines that begin with # are comments; "-" stands for no value
};

/// Reads a table row by row. Errors name file and line.
///
/// CSV may come from a spreadsheet: a first line `sep=;`, semicolons or tabs in place of commas, values in quotes,
/// empty columns and rows behind the last ones, a mark of its encoding. With semicolons or tabs, or in quotes, a comma
/// may stand for the decimal point, if it does so in the whole file. What could be read in two ways is an error.
class TableReader {
 public:
  /// Throws Error for a file that cannot be read and, in CSV, for a required column that is missing or a column that
  /// appears twice; `remedy` says what the first line should be. An empty file has no columns and no rows.
  TableReader(std::filesystem::path file, TableStyle style, std::vector<std::string> required, std::string remedy);

  const std::vector<std::string>& columns() const { return columns_; }
  std::optional<std::size_t> find(std::string_view column) const;

  /// Goes to the next row; false behind the last. Throws Error for a CSV row with too few or too many values, and for a
  /// vnlog row above which no line names the required columns.
  bool next();

  std::string where() const;  ///< "FILE:12", the line of this row
  /// The last row's line and everything behind it, roughly: for reserving memory.
  std::size_t rows_left() const;

  /// A value of this row. Throws Error for a vnlog row that ends before it.
  std::string_view text(std::size_t column) const;
  /// Whether there is one (vnlog).
  bool has(std::size_t column) const { return column < values_.size() && values_[column] != "-"; }
  /// Throws Error naming the column for what is no finite number.
  double number(std::size_t column) const;
  /// And for what is no whole number, or none that an int holds.
  int whole(std::size_t column) const;
  /// And for what is not above 0.
  double positive(std::size_t column) const;
  /// Throws Error: this row's column `is` something that it should not be.
  [[noreturn]] void fail_at(std::size_t column, const std::string& what, const std::string& remedy) const;

 private:
  std::string_view next_line();
  void read_csv_header();
  void fail_unless_text() const;
  std::string_view quoted(std::string_view& line);
  std::optional<double> number_or_none(std::size_t column) const;
  void count_row();
  void split_csv(std::string_view line);
  void split_words(std::string_view line);

  std::filesystem::path file_;
  TableStyle style_;
  std::vector<std::string> required_, columns_;
  std::string remedy_;
  std::string content_;
  std::string_view rest_;
  std::size_t line_ = 0, rows_ = 0;
  std::vector<std::string_view> values_;
  std::vector<bool> in_quotes_;    ///< which of them stood in quotes
  char separator_ = ',';           ///< of CSV
  mutable char decimal_mark_ = 0;  ///< . or , once a value has told
};

}  // namespace burin
