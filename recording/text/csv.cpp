#include "recording/text/csv.h"

#include <algorithm>
#include <cmath>

#include "core/check.h"
#include "recording/text/text.h"

namespace flextip {
namespace {

void Split(std::string_view line, std::vector<std::string_view>& fields) {
  fields.clear();
  for (std::size_t begin = 0;;) {
    const auto comma = line.find(',', begin);
    fields.push_back(Trim(line.substr(begin, comma - begin)));
    if (comma == std::string_view::npos) return;
    begin = comma + 1;
  }
}

}  // namespace

CsvReader::CsvReader(const std::filesystem::path& file, const std::vector<std::string>& columns,
                     ReadLog& log, const CsvOptions& options)
    : file_(file.string()),
      columns_(columns),
      options_(options),
      log_(&log),
      text_(ReadTextFile(file)) {
  ReadHeader(options.allow_other_columns);
}

InputError CsvReader::Error(const std::string& what) const {
  return InputError::At(file_, line_, what);
}

bool CsvReader::TakeLine(std::string_view& line, bool& terminated) {
  if (position_ >= text_.size()) return false;
  const auto end = text_.find('\n', position_);
  terminated = end != std::string::npos;
  line = std::string_view(text_).substr(position_, end - position_);
  position_ = terminated ? end + 1 : text_.size();
  ++line_;
  return true;
}

void CsvReader::ReadHeader(bool allow_other_columns) {
  if (text_.starts_with("\xEF\xBB\xBF")) position_ = 3;  // a byte order mark
  std::string_view line;
  bool terminated = false;
  const bool found = TakeLine(line, terminated) && !Trim(line).empty();
  line_ = 1;
  if (!found) throw Error("empty, expected a header with the names of the columns");
  line = Trim(line);
  if (options_.from_recorder && line.front() != '#') {
    throw Error(fmt::format("found {}, expected a header that starts with \"#{}\"", Quoted(line),
                            columns_.front()));
  }
  if (line.front() == '#') line.remove_prefix(1);
  Split(line, fields_);
  width_ = fields_.size();
  for (const auto& column : columns_) {
    const auto place = std::find(fields_.begin(), fields_.end(), column);
    if (place == fields_.end()) throw Error(fmt::format("column \"{}\" is missing", column));
    if (std::find(place + 1, fields_.end(), column) != fields_.end()) {
      throw Error(fmt::format("column \"{}\" is there twice", column));
    }
    place_.push_back(static_cast<std::size_t>(place - fields_.begin()));
  }
  if (allow_other_columns) return;
  for (const auto field : fields_) {
    if (std::find(columns_.begin(), columns_.end(), field) != columns_.end()) continue;
    throw Error(
        fmt::format("extra column {}, expected {} columns", Quoted(field), columns_.size()));
  }
}

// A line that was not ended may have lost digits of its last number too, so it is not trusted even
// where all its fields are there.
bool CsvReader::IsTorn(std::size_t fields, bool terminated) const {
  if (!options_.from_recorder || fields > width_) return false;
  const bool is_last = text_.find_first_not_of(" \t\r\n", position_) == std::string::npos;
  return is_last && (!terminated || fields < width_);
}

bool CsvReader::Next() {
  std::string_view line;
  bool terminated = false;
  if (!TakeLine(line, terminated)) return false;
  if (Trim(line).empty() && text_.find_first_not_of(" \t\r\n", position_) == std::string::npos) {
    return false;  // nothing but line breaks to the end
  }
  Split(line, fields_);
  if (IsTorn(fields_.size(), terminated)) {
    position_ = text_.size();
    ++log_->torn_lines;
    log_->warnings.emplace_back(
        Error(fmt::format("skipped a torn last line: {} of {} fields{}", fields_.size(), width_,
                          terminated ? "" : ", no line break at its end"))
            .what());
    return false;
  }
  if (fields_.size() != width_) {
    throw Error(fmt::format("found {} fields, expected {}", fields_.size(), width_));
  }
  return true;
}

std::string_view CsvReader::Text(std::size_t column) const { return fields_[place_[column]]; }

InputError CsvReader::FieldError(std::size_t column, const std::string& expected) const {
  return Error(fmt::format("found {} in column \"{}\", expected {}", Quoted(Text(column)),
                           columns_[column], expected));
}

double CsvReader::Number(std::size_t column) const {
  const auto value = ParseFinite(Text(column));
  if (!value) throw FieldError(column, "a finite number");
  return *value;
}

TimeNs CsvReader::Integer(std::size_t column) const {
  const auto value = ParseInteger(Text(column));
  if (!value) throw FieldError(column, "an integer");
  return *value;
}

CsvWriter::CsvWriter(const std::vector<std::string>& columns, bool from_recorder)
    : width_(columns.size()) {
  if (from_recorder) text_ += '#';
  for (const auto& column : columns) Add(column);
  EndRow();
}

void CsvWriter::Separate() {
  if (fields_++ > 0) text_ += ',';
}

CsvWriter& CsvWriter::Add(double value) {
  if (!std::isfinite(value)) throw WorkError("a table to be written holds a NaN or infinite value");
  Separate();
  text_ += NumberText(value);
  return *this;
}

CsvWriter& CsvWriter::Add(TimeNs value) {
  Separate();
  text_ += std::to_string(value);
  return *this;
}

CsvWriter& CsvWriter::Add(const std::string& text) {
  FLEXTIP_CHECK(text.find_first_of(",\n\r") == std::string::npos, "no separator within a field");
  Separate();
  text_ += text;
  return *this;
}

CsvWriter& CsvWriter::AddEmpty(int count) {
  for (int i = 0; i < count; ++i) Separate();
  return *this;
}

void CsvWriter::EndRow() {
  FLEXTIP_CHECK(fields_ == width_, "a field for each column");
  fields_ = 0;
  text_ += '\n';
}

}  // namespace flextip
