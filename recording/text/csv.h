// Comma-separated tables, the only dialect that flextip writes and reads: a header of column names
// (after a '#' in a recorder's tables), one row a line, fields in quotes where they hold a comma or
// a quote (RFC 4180 without line breaks in fields). Errors name file, line, found and expected.
#pragma once

#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/error.h"
#include "core/time_series.h"
#include "recording/read_log.h"
#include "recording/text/bounds.h"

namespace flextip {

struct CsvOptions {
  /// A recorder's table: the header starts with '#', a torn last line is skipped and reported. A
  /// last line is torn where the line break after it or some of its fields are missing. Otherwise
  /// the '#' may be absent, the line break after the last line too, and every line must be whole.
  bool from_recorder = true;
  bool allow_other_columns = false;        ///< ignore columns that were not asked for
  std::vector<std::string> may_lack = {};  ///< columns asked for that are empty where not there
};

/// Reads a table row by row, and holds one row at a time. Columns are found by their names, in any
/// order. Spaces around names and fields do not matter.
class CsvReader {
 public:
  /// Reads `columns` of the table. Throws InputError for an unreadable file, an absent header, and
  /// missing, extra or repeated columns.
  CsvReader(const std::filesystem::path& file, const std::vector<std::string>& columns,
            ReadLog& log, const CsvOptions& options = {});
  /// Reads all columns, as in the header. Throws InputError for an unreadable file and an absent
  /// header.
  CsvReader(const std::filesystem::path& file, ReadLog& log, const CsvOptions& options = {});

  const std::vector<std::string>& Columns() const { return columns_; }

  /// Goes to the next row; false after the last. Throws InputError for a wrong number of fields.
  bool Next();

  /// Returns a field of the current row; `column` counts as in the constructor's `columns`.
  std::string_view Text(std::size_t column) const;
  bool Empty(std::size_t column) const { return Text(column).empty(); }
  /// Returns a finite number within the bounds of the column's unit. Throws InputError for anything
  /// else.
  double Number(std::size_t column) const;
  TimeNs Integer(std::size_t column) const;

  long line() const { return line_; }
  /// Returns an error at the current line.
  InputError Error(const std::string& what) const;

 private:
  void ReadHeader();
  void FindColumns();
  void FindBounds();
  bool TakeLine();
  bool OnlyBlanksFollow();
  bool IsTorn();
  void SkipTorn();
  /// Splits the line into fields. Returns the reason where it cannot; else an empty text.
  std::string SplitLine();
  InputError FieldError(std::size_t column, const std::string& expected) const;

  static constexpr std::size_t kLacking = static_cast<std::size_t>(-1);
  std::string file_;
  std::vector<std::string> columns_;
  CsvOptions options_;
  ReadLog* log_;
  std::ifstream stream_;
  std::string text_;         ///< the current line; fields in quotes are unquoted in place
  bool terminated_ = false;  ///< a line break ended it
  long line_ = 0;
  std::size_t width_ = 0;                        ///< fields in a row
  std::vector<std::size_t> place_;               ///< of each wanted column in a row; or kLacking
  std::vector<Bounds> bounds_, integer_bounds_;  ///< of each wanted column's numbers
  std::vector<std::string_view> fields_;         ///< of the current row, views into text_
};

/// Builds a table in memory.
class CsvWriter {
 public:
  explicit CsvWriter(const std::vector<std::string>& columns, bool from_recorder = true);

  /// From now on refuses what CsvReader would: numbers beyond the bounds of their column's unit.
  void KeepBounds();

  /// Adds the number exactly, or with so many `digits`. Throws WorkError for NaN and infinities,
  /// and for what KeepBounds refuses.
  CsvWriter& Add(double value, int digits = 0);
  /// Adds an empty field where the value is NaN or infinite.
  CsvWriter& AddOrEmpty(double value, int digits = 0);
  /// Adds the number with so many decimals; an empty field where it is NaN or infinite.
  CsvWriter& AddFixed(double value, int decimals);
  CsvWriter& Add(TimeNs value);
  /// Adds a text, in quotes where it needs them; a '?' for each line break.
  CsvWriter& Add(const std::string& text);
  CsvWriter& AddEmpty(int count = 1);
  void EndRow();  ///< the row must be full

  const std::string& text() const { return text_; }
  /// Returns the text since the last call, for tables that go to the disk row by row.
  std::string TakeText() { return std::exchange(text_, {}); }

 private:
  void Separate();

  std::vector<std::string> names_;
  std::vector<Bounds> bounds_;  ///< of each column's numbers; empty: none
  std::size_t width_;
  std::size_t fields_ = 0;
  std::string text_;
};

}  // namespace flextip
