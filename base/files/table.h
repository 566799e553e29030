// burin/base/files/table.h - tables of text, one row per line, columns by name: CSV (scratches, footprint integrals)
// and vnlog (residuals, chessboards' corners). docs/file-formats.md.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace burin {

/// A finite number with a decimal point, independent of the locale. A leading plus sign is permitted; a number below
/// the range of a double is 0. Nothing for any other text.
std::optional<double> number_in(std::string_view text);

enum class TableStyle {
  /// Values between commas, or as a spreadsheet writes them (below); the first line names the columns; every row has a
  /// value per column
  csv,
  /// Words; the first line of the form "# name name ..." with all required columns names them; later lines with # are
  /// comments; "-" means no value
  vnlog
};

/// Reads a table row by row. Errors name file and line.
///
/// CSV may come from a spreadsheet, with a first line `sep=;`, semicolons or tabs instead of commas, quoted values,
/// empty columns and rows at the end, or a byte order mark. With semicolons, tabs or quotes, a comma may be the decimal
/// mark, if it is so in the whole file. Ambiguous text is an error.
class TableReader {
 public:
  /// Throws Error for an unreadable file and, in CSV, for a missing required column or a duplicate column. `remedy`
  /// describes the correct first line. An empty file has no columns and no rows.
  TableReader(std::filesystem::path file, TableStyle style, std::vector<std::string> required, std::string remedy);

  const std::vector<std::string>& columns() const { return columns_; }
  std::optional<std::size_t> find(std::string_view column) const;

  /// Goes to the next row; returns false after the last. Throws Error for a CSV row with too few or too many values,
  /// and for a vnlog row without an earlier header with the required columns.
  bool next();

  std::string where() const;  ///< "FILE:12", the line of this row
  /// Approximate number of remaining rows, the current one included: for reserving memory.
  std::size_t rows_left() const;

  /// A value of this row. Throws Error for a shorter vnlog row.
  std::string_view text(std::size_t column) const;
  /// True if the row has a value there (vnlog).
  bool has(std::size_t column) const { return column < values_.size() && values_[column] != "-"; }
  /// Throws Error with the column for text other than a finite number.
  double number(std::size_t column) const;
  /// Also throws for a fraction and for a number out of int's range.
  int whole(std::size_t column) const;
  /// Also throws for a number not above 0.
  double positive(std::size_t column) const;
  /// Throws Error about this row's column; `what` describes the fault.
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
  std::vector<bool> in_quotes_;    ///< true for values in quotes
  char separator_ = ',';           ///< of CSV
  mutable char decimal_mark_ = 0;  ///< . or , as soon as a value determines it
};

}  // namespace burin
