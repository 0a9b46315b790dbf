#include "recording/text/csv.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/check.h"
#include "recording/text/text.h"

namespace flextip {
CsvReader::CsvReader(const std::filesystem::path& file, const std::vector<std::string>& columns,
                     ReadLog& log, const CsvOptions& options)
    : file_(file.string()),
      columns_(columns),
      options_(options),
      log_(&log),
      stream_(OpenFile(file)) {
  ReadHeader();
  FindColumns();
  FindBounds();
}

CsvReader::CsvReader(const std::filesystem::path& file, ReadLog& log, const CsvOptions& options)
    : file_(file.string()), options_(options), log_(&log), stream_(OpenFile(file)) {
  ReadHeader();
  for (std::size_t i = 0; i < width_; ++i) {
    columns_.emplace_back(fields_[i]);
    place_.push_back(i);
  }
  FindBounds();
}

void CsvReader::FindBounds() {
  constexpr Bounds kAnyInteger{4e18, 1.0, ""};
  for (const auto& column : columns_) {
    const auto bounds = KnownBoundsOf(column);
    bounds_.push_back(bounds.value_or(Bounds{}));
    integer_bounds_.push_back(bounds.value_or(kAnyInteger));
  }
}

InputError CsvReader::Error(const std::string& what) const {
  return InputError::At(file_, line_, what);
}

bool CsvReader::TakeLine() {
  if (stream_.eof() || !std::getline(stream_, text_)) {
    if (stream_.bad()) throw Error("cannot be read to its end");
    return false;
  }
  terminated_ = !stream_.eof();
  ++line_;
  return true;
}

void CsvReader::ReadHeader() {
  const bool found = TakeLine();
  line_ = 1;
  if (text_.starts_with("\xEF\xBB\xBF")) text_.erase(0, 3);  // a byte order mark
  const std::string_view header = Trim(text_);
  if (!found || header.empty()) {
    throw Error("empty, expected a header with the names of the columns");
  }
  if (options_.from_recorder && header.front() != '#') {
    throw Error(fmt::format("found {}, expected a header that starts with \"#{}\"", Quoted(header),
                            columns_.empty() ? "" : columns_.front()));
  }
  text_ = header.front() == '#' ? header.substr(1) : header;
  if (const std::string problem = SplitLine(); !problem.empty()) throw Error(problem);
  width_ = fields_.size();
}

void CsvReader::FindColumns() {
  const auto& lacking = options_.may_lack;
  for (const auto& column : columns_) {
    const auto place = std::find(fields_.begin(), fields_.end(), column);
    if (place == fields_.end() &&
        std::find(lacking.begin(), lacking.end(), column) != lacking.end()) {
      place_.push_back(kLacking);
      continue;
    }
    if (place == fields_.end()) throw Error(fmt::format("column \"{}\" is missing", column));
    if (std::find(place + 1, fields_.end(), column) != fields_.end()) {
      throw Error(fmt::format("column \"{}\" is there twice", column));
    }
    place_.push_back(static_cast<std::size_t>(place - fields_.begin()));
  }
  if (options_.allow_other_columns) return;
  for (const auto field : fields_) {
    if (std::find(columns_.begin(), columns_.end(), field) != columns_.end()) continue;
    throw Error(
        fmt::format("extra column {}, expected {} columns", Quoted(field), columns_.size()));
  }
}

std::string CsvReader::SplitLine() {
  fields_.clear();
  for (std::size_t begin = 0;;) {
    const auto first = text_.find_first_not_of(" \t\r", begin);
    std::size_t end = begin;  // past the quotes
    if (first != std::string::npos && text_[first] == '"') {
      std::size_t written = first;
      bool closed = false;
      for (end = first + 1; end < text_.size() && !closed; ++end) {
        const bool is_quote = text_[end] == '"';
        const bool is_doubled = is_quote && end + 1 < text_.size() && text_[end + 1] == '"';
        closed = is_quote && !is_doubled;
        if (is_doubled) ++end;
        if (!closed) text_[written++] = text_[end];
      }
      if (!closed) return "a quote is not closed";
      fields_.push_back(std::string_view(text_).substr(first, written - first));
    }
    const auto comma = text_.find(',', end);
    const auto rest = Trim(std::string_view(text_).substr(end, comma - end));
    if (end == begin) {
      fields_.push_back(rest);
    } else if (!rest.empty()) {
      return fmt::format("found {} after a closing quote", Quoted(rest));
    }
    if (comma == std::string::npos) return "";
    begin = comma + 1;
  }
}

bool CsvReader::OnlyBlanksFollow() {
  if (stream_.eof()) return true;
  const auto here = stream_.tellg();
  stream_ >> std::ws;
  const bool at_end = stream_.eof();
  stream_.clear();
  stream_.seekg(here);
  return at_end;
}

// A line that was not ended may have lost digits of its last number too, so it is not trusted even
// where all its fields are there.
bool CsvReader::IsTorn() {
  if (!options_.from_recorder || fields_.size() > width_) return false;
  return (!terminated_ || fields_.size() < width_) && OnlyBlanksFollow();
}

void CsvReader::SkipTorn() {
  stream_.setstate(std::ios::eofbit);
  ++log_->torn_lines;
  log_->warnings.emplace_back(
      Error(fmt::format("skipped a torn last line: {} of {} fields{}", fields_.size(), width_,
                        terminated_ ? "" : ", no line break at its end"))
          .what());
}

bool CsvReader::Next() {
  if (!TakeLine()) return false;
  if (Trim(text_).empty() && OnlyBlanksFollow()) return false;
  const std::string problem = SplitLine();
  if (IsTorn()) {
    SkipTorn();
    return false;
  }
  if (!problem.empty()) throw Error(problem);
  if (fields_.size() != width_) {
    throw Error(fmt::format("found {} fields, expected {}", fields_.size(), width_));
  }
  return true;
}

std::string_view CsvReader::Text(std::size_t column) const {
  return place_[column] == kLacking ? std::string_view() : fields_[place_[column]];
}

InputError CsvReader::FieldError(std::size_t column, const std::string& expected) const {
  return Error(fmt::format("found {} in column \"{}\", expected {}", Quoted(Text(column)),
                           columns_[column], expected));
}

double CsvReader::Number(std::size_t column) const {
  const auto value = ParseFinite(Text(column));
  if (!value) throw FieldError(column, "a finite number");
  const std::string within = ExpectedWithin(bounds_[column], *value);
  if (!within.empty()) throw FieldError(column, within);
  return *value;
}

TimeNs CsvReader::Integer(std::size_t column) const {
  const auto value = ParseInteger(Text(column));
  if (!value) throw FieldError(column, "an integer");
  const std::string within = ExpectedWithin(integer_bounds_[column], static_cast<double>(*value));
  if (!within.empty()) throw FieldError(column, within);
  return *value;
}

CsvWriter::CsvWriter(const std::vector<std::string>& columns, bool from_recorder)
    : names_(columns), width_(columns.size()) {
  if (from_recorder) text_ += '#';
  for (const auto& column : columns) Add(column);
  EndRow();
}

void CsvWriter::KeepBounds() {
  for (const auto& column : names_) {
    constexpr double kAny = std::numeric_limits<double>::max();
    bounds_.push_back(KnownBoundsOf(column).value_or(Bounds{kAny, 0.0, ""}));
  }
}

void CsvWriter::Separate() {
  if (fields_++ > 0) text_ += ',';
}

CsvWriter& CsvWriter::Add(double value, int digits) {
  if (!std::isfinite(value)) {
    throw WorkError(fmt::format(
        "the result's \"{}\" came out as {}: no number of the input was refused, but together "
        "they are too large or too small to calculate with",
        fields_ < width_ ? names_[fields_] : "", value));
  }
  if (fields_ < bounds_.size()) {  // what a reader would refuse
    const std::string expected = ExpectedWithin(bounds_[fields_], value);
    if (!expected.empty()) {
      throw WorkError(fmt::format("the result's \"{}\" came out as {:g}, expected {}",
                                  names_[fields_], value, expected));
    }
  }
  Separate();
  text_ += digits > 0 ? fmt::format("{:.{}g}", value, digits) : NumberText(value);
  return *this;
}

CsvWriter& CsvWriter::AddOrEmpty(double value, int digits) {
  return std::isfinite(value) ? Add(value, digits) : AddEmpty();
}

CsvWriter& CsvWriter::AddFixed(double value, int decimals) {
  return std::isfinite(value) ? Add(fmt::format("{:.{}f}", value, decimals)) : AddEmpty();
}

CsvWriter& CsvWriter::Add(TimeNs value) {
  Separate();
  text_ += std::to_string(value);
  return *this;
}

CsvWriter& CsvWriter::Add(const std::string& text) {
  if (text.find_first_of("\n\r") != std::string::npos) {
    std::string line = text;  // a file's name may hold anything
    for (char& c : line) c = c == '\n' || c == '\r' ? '?' : c;
    return Add(line);
  }
  Separate();
  if (text.find_first_of(",\"") == std::string::npos && Trim(text).size() == text.size()) {
    text_ += text;
    return *this;
  }
  text_ += '"';
  for (const char c : text) {
    if (c == '"') text_ += c;
    text_ += c;
  }
  text_ += '"';
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
