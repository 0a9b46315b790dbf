#include "exchange/tables/delimited_table.h"

#include <algorithm>
#include <map>

#include "exchange/tables/fields.h"
#include "exchange/values/units.h"
#include "recording/text/text.h"

namespace flextip::exchange {
namespace {

constexpr std::size_t kLookedAt = 100;  // lines
constexpr double kMostOdd = 0.1;        // share of lines that may be of another width

bool IsBracketed(std::string_view field) {
  return field.size() > 1 && (field.front() == '[' || field.front() == '(');
}

}  // namespace

DelimitedTable::DelimitedTable(const std::filesystem::path& file, const Dialect& told)
    : file_(file.string()), text_(ReadTextFile(file)) {
  if (text_.starts_with("\xEF\xBB\xBF")) text_.erase(0, 3);
  if (text_.starts_with("\xFF\xFE") || text_.starts_with("\xFE\xFF")) {
    throw InputError::At(file_, 1, "found UTF-16, expected UTF-8: save the table as UTF-8");
  }
  if (text_.find('\0') != std::string::npos) {
    throw InputError::At(file_, 0, "holds bytes that are no text, expected a table");
  }
  FindSeparator(told);
  FindDecimal(told);
  FindHeader(told);
  FindUnitRow();
  first_row_ = at_;
  first_row_line_ = line_;
}

// The next line that is neither blank nor a comment.
bool DelimitedTable::TakeLine(std::string_view& line) {
  while (at_ < text_.size()) {
    const std::size_t end = std::min(text_.find('\n', at_), text_.size());
    line = std::string_view(text_).substr(at_, end - at_);
    at_ = end + 1;
    ++line_;
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    if (!Trim(line).empty() && !IsComment(line)) return true;
  }
  return false;
}

// Returns what is wrong; else an empty text.
std::string DelimitedTable::Split(std::string_view line, char separator, Fields& fields) {
  fields.clear();
  const std::string_view ends = separator == ' ' ? " \t" : std::string_view(&separator, 1);
  const auto is_blank = [&](char c) { return c == ' ' || (c == '\t' && separator != '\t'); };
  std::size_t i = 0;
  while (true) {
    while (i < line.size() && is_blank(line[i])) ++i;
    if (separator == ' ' && i == line.size()) break;
    if (i < line.size() && line[i] == '"') {
      std::string text;
      const std::size_t begin = ++i;
      bool doubled = false;
      for (;; ++i) {
        if (i >= line.size()) return "a quote is not closed";
        if (line[i] != '"') {
          text += line[i];
        } else if (i + 1 < line.size() && line[i + 1] == '"') {
          text += line[i++];
          doubled = true;
        } else {
          break;
        }
      }
      const std::string_view inside = line.substr(begin, i - begin);
      fields.push_back(Trim(doubled ? std::string_view(unquoted_.emplace_back(text)) : inside));
      ++i;
      while (i < line.size() && is_blank(line[i]) && separator != ' ') ++i;
      if (i < line.size() && ends.find(line[i]) == std::string_view::npos) {
        return "found text behind a closing quote, expected the end of the field";
      }
    } else {
      const std::size_t end = std::min(line.find_first_of(ends, i), line.size());
      fields.push_back(Trim(line.substr(i, end - i)));
      i = end;
    }
    if (i >= line.size()) break;
    ++i;
  }
  return "";
}

std::vector<std::string_view> DelimitedTable::FirstLines() {
  std::vector<std::string_view> lines;
  std::string_view line;
  while (lines.size() < kLookedAt && TakeLine(line)) lines.push_back(line);
  at_ = 0;
  line_ = 0;
  return lines;
}

// Whether most lines have one number of fields, and none with two numbers in it.
bool DelimitedTable::FitsSeparator(const std::vector<std::string_view>& lines, char separator,
                                   std::size_t& width) {
  std::map<std::size_t, std::size_t> widths;
  Fields fields;
  for (const auto line : lines) {
    if (Split(line, separator, fields).empty()) ++widths[fields.size()];
  }
  width = 0;
  for (const auto& [size, count] : widths) {
    if (width == 0 || count > widths[width]) width = size;
  }
  if (width < 2) return false;
  std::size_t first = 0, fitting = 0, odd = 0;
  while (!Split(lines[first], separator, fields).empty() || fields.size() != width) ++first;
  for (std::size_t i = first; i < lines.size(); ++i) {
    if (!Split(lines[i], separator, fields).empty() || fields.size() != width) continue;
    ++fitting;
    if (std::any_of(fields.begin(), fields.end(), HoldsSeveralNumbers)) ++odd;
  }
  const auto all = static_cast<double>(lines.size() - first);
  return static_cast<double>(fitting) >= (1 - kMostOdd) * all - 1 &&
         static_cast<double>(odd) <= kMostOdd * all;
}

void DelimitedTable::FindSeparator(const Dialect& told) {
  const auto lines = FirstLines();
  if (lines.empty()) throw InputError::At(file_, 0, "no rows, expected a table");
  if (told.separator) {
    separator_ = *told.separator;
    (void)FitsSeparator(lines, separator_, width_);
    return;
  }
  for (const char candidate : {';', '\t', ',', ' '}) {
    separator_ = candidate;
    if (FitsSeparator(lines, candidate, width_)) return;
  }
  separator_ = ';';  // a single column: nothing separates
  width_ = 1;
}

void DelimitedTable::FindDecimal(const Dialect& told) {
  bool point = false, comma = false;
  Fields fields;
  for (const auto line : FirstLines()) {
    if (!Split(line, separator_, fields).empty()) continue;
    for (const auto field : fields) {
      point = point || HasDecimal(field, '.');
      comma = comma || HasDecimal(field, ',');
    }
  }
  decimal_ = told.decimal ? *told.decimal : comma && !point ? ',' : '.';
}

void DelimitedTable::NameColumns(const Fields& fields) {
  columns_.assign(fields.begin(), fields.end());
  has_header_ = true;
}

void DelimitedTable::FindHeader(const Dialect& told) {
  // Comments above the table may name its columns: "#timestamp [ns],x [m]".
  Fields named, fields;
  std::size_t begin = 0;
  std::string_view line;
  for (std::string_view rest = text_; !rest.empty();) {
    const std::size_t end = std::min(rest.find('\n'), rest.size());
    std::string_view comment = Trim(rest.substr(0, end));
    rest.remove_prefix(std::min(end + 1, rest.size()));
    if (comment.empty()) continue;
    if (!IsComment(comment)) break;
    comment.remove_prefix(comment.find_first_not_of("#%") == std::string_view::npos
                              ? comment.size()
                              : comment.find_first_not_of("#%"));
    if (Split(Trim(comment), separator_, fields).empty() && fields.size() == width_ &&
        NamesColumns(fields)) {
      named = fields;
    }
  }
  std::size_t skipped = 0;
  while (TakeLine(line)) {
    const bool whole = Split(line, separator_, fields).empty();
    if (whole && (fields.size() == width_ || width_ <= 1)) break;
    begin = at_;
    ++skipped;
  }
  if (skipped > 0) {
    remarks_.push_back(fmt::format("{}: left out {} lines above the table", file_, skipped));
  }
  if (told.header.value_or(NamesColumns(fields))) {
    if (named.empty() || NamesColumns(fields)) {
      if (width_ > 1 && fields.back().empty()) fields.pop_back(), --width_;
      NameColumns(fields);
      return;
    }
  }
  at_ = begin;  // the row is data
  line_ = static_cast<long>(
      std::count(text_.begin(),
                 text_.begin() + static_cast<std::ptrdiff_t>(std::min(at_, text_.size())), '\n'));
  if (!named.empty() && told.header.value_or(true)) {
    NameColumns(named);
    return;
  }
  for (std::size_t i = 0; i < width_; ++i) columns_.push_back(std::to_string(i + 1));
}

// A second line of the header that holds units alone.
void DelimitedTable::FindUnitRow() {
  if (!has_header_) return;
  const auto begin = at_;
  const auto begin_line = line_;
  Fields fields;
  std::string_view line;
  bool units = TakeLine(line) && Split(line, separator_, fields).empty() &&
               fields.size() == columns_.size() && NamesColumns(fields);
  for (const auto field : fields) {
    units = units && (field.empty() || field == "-" || IsBracketed(field) || ParseUnit(field));
  }
  if (!units) {
    at_ = begin;
    line_ = begin_line;
    return;
  }
  for (std::size_t i = 0; i < fields.size(); ++i) {
    if (fields[i].empty() || fields[i] == "-") continue;
    const std::string unit(fields[i]);
    columns_[i] += IsBracketed(fields[i]) ? " " + unit : " [" + unit + "]";
  }
}

bool DelimitedTable::Next() {
  std::string_view line;
  while (TakeLine(line)) {
    unquoted_.clear();
    const std::string problem = Split(line, separator_, fields_);
    if (fields_.size() == columns_.size() + 1 && fields_.back().empty()) fields_.pop_back();
    const bool all_empty = std::all_of(fields_.begin(), fields_.end(),
                                       [](std::string_view field) { return field.empty(); });
    if (all_empty && problem.empty()) continue;
    if (problem.empty() && fields_.size() == columns_.size()) return true;
    if (at_ > text_.size() && fields_.size() < columns_.size()) {  // no line break ends it
      remarks_.push_back(fmt::format("{}:{}: left out a torn last line", file_, line_));
      return false;
    }
    throw Error(problem.empty()
                    ? fmt::format("found {} fields, expected {}", fields_.size(), columns_.size())
                    : problem);
  }
  return false;
}

std::optional<double> DelimitedTable::Number(std::size_t column) const {
  return NumberOrMissing(Plain(column));
}

std::string DelimitedTable::Plain(std::size_t column) const {
  return WithPoint(fields_[column], decimal_);
}

}  // namespace flextip::exchange
