// Tables of other programs: the separator, the decimal sign, the header and comments are found by
// looking. recording/text/csv.h reads this program's own dialect, strictly.
#pragma once

#include <deque>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/error.h"

namespace flextip::exchange {

/// Whatever is empty is found by looking at the table.
struct Dialect {
  std::optional<char> separator;  ///< , ; tab, or a blank for any number of blanks
  std::optional<char> decimal;    ///< . or ,
  std::optional<bool> header;     ///< whether the table names its columns
};

/// Reads a table row by row. Lines that begin with # or % are comments; the last one above the
/// table is its header where the table has none of its own and the number of names fits.
class DelimitedTable {
 public:
  /// Throws InputError for an unreadable file, another encoding than UTF-8, and no rows.
  explicit DelimitedTable(const std::filesystem::path& file, const Dialect& told = {});

  const std::string& file() const { return file_; }
  char separator() const { return separator_; }
  char decimal() const { return decimal_; }
  bool has_header() const { return has_header_; }
  /// Names with their units; without a header their numbers from 1.
  const std::vector<std::string>& Columns() const { return columns_; }

  /// Goes to the next row; false after the last. Throws InputError for a wrong number of fields. A
  /// last line without a line break that lacks fields is left out.
  bool Next();
  void Rewind() {
    at_ = first_row_;
    line_ = first_row_line_;
  }

  std::string_view Text(std::size_t column) const { return fields_[column]; }
  /// NaN for a missing value, empty for what is no number (NumberOrMissing).
  std::optional<double> Number(std::size_t column) const;
  /// The field with a decimal point.
  std::string Plain(std::size_t column) const;

  long line() const { return line_; }
  InputError Error(const std::string& what) const { return InputError::At(file_, line_, what); }

  /// What was left out: lines above the table, a torn last line.
  const std::vector<std::string>& Remarks() const { return remarks_; }

 private:
  using Fields = std::vector<std::string_view>;

  bool TakeLine(std::string_view& line);
  std::string Split(std::string_view line, char separator, Fields& fields);
  std::vector<std::string_view> FirstLines();
  void FindSeparator(const Dialect& told);
  void FindDecimal(const Dialect& told);
  void FindHeader(const Dialect& told);
  void FindUnitRow();
  void NameColumns(const Fields& fields);
  bool FitsSeparator(const std::vector<std::string_view>& lines, char separator,
                     std::size_t& width);

  std::string file_, text_;
  char separator_ = ',', decimal_ = '.';
  bool has_header_ = false;
  std::vector<std::string> columns_, remarks_;
  std::size_t width_ = 0;
  std::size_t at_ = 0, first_row_ = 0;  // in text_
  long line_ = 0, first_row_line_ = 0;
  Fields fields_;
  std::deque<std::string> unquoted_;  // fields with doubled quotes
};

}  // namespace flextip::exchange
