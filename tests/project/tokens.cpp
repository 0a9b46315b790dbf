#include "tests/project/tokens.h"

#include <algorithm>
#include <cctype>

namespace flextip {
namespace {

bool IsPartOfWord(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; }

/// Goes through a source piece by piece and keeps count of its lines.
class Scanner {
 public:
  explicit Scanner(const std::string& source) : source_(source) {}

  void Run() {
    while (at_ < source_.size()) Next();
  }
  std::vector<Token> tokens, strings;

 private:
  bool Sees(const char* text) const {
    return source_.compare(at_, std::string(text).size(), text) == 0;
  }
  /// Returns the text up to `end` and moves there.
  std::string Take(std::size_t end) {
    end = std::min(end, source_.size());
    const std::string text = source_.substr(at_, end - at_);
    line_ += static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
    at_ = end;
    return text;
  }
  std::size_t After(const std::string& text, std::size_t from) const {
    const std::size_t found = source_.find(text, from);
    return found == std::string::npos ? source_.size() : found + text.size();
  }

  void Next() {
    const char c = source_[at_];
    if (c == '\n') starts_line_ = true;
    if (std::isspace(static_cast<unsigned char>(c)) != 0) {
      Take(at_ + 1);
    } else if (Sees("//")) {
      Take(source_.find('\n', at_));
    } else if (Sees("/*")) {
      Take(After("*/", at_ + 2));
    } else if (c == '#' && starts_line_) {
      TakeDirective();
    } else if (Sees("R\"")) {
      TakeRawString();
    } else if (c == '"' || c == '\'') {
      TakeLiteral(c);
    } else {
      TakeWordOrSign();
    }
  }

  void TakeDirective() {
    std::size_t end = source_.find('\n', at_);
    while (end != std::string::npos && source_[end - 1] == '\\') end = source_.find('\n', end + 1);
    Take(end);
  }
  void TakeRawString() {
    const std::size_t line = line_, open = source_.find('(', at_);
    const std::string close = ")" + source_.substr(at_ + 2, open - at_ - 2) + "\"";
    const std::string text = Take(After(close, open));
    const std::size_t before = close.size() + 1;  // R"( and the delimiter
    AddString(text.substr(before, text.size() - before - close.size()), line);
  }
  void TakeLiteral(char quote) {
    const std::size_t line = line_;
    std::size_t end = at_ + 1;
    while (end < source_.size() && source_[end] != quote) end += source_[end] == '\\' ? 2 : 1;
    const std::string text = Take(end + 1);
    if (quote == '"') {
      AddString(text.substr(1, text.size() - 2), line);
    } else {
      tokens.push_back({"'", line});
    }
  }
  void AddString(const std::string& text, std::size_t line) {
    tokens.push_back({"\"", line});
    strings.push_back({text, line});
    starts_line_ = false;
  }
  void TakeWordOrSign() {
    starts_line_ = false;
    const std::size_t line = line_;
    std::size_t end = at_ + 1;
    if (IsPartOfWord(source_[at_])) {
      // A digit separator is part of a number.
      const bool number = std::isdigit(static_cast<unsigned char>(source_[at_])) != 0;
      while (end < source_.size() &&
             (IsPartOfWord(source_[end]) || (number && source_[end] == '\'')))
        ++end;
    } else if (Sees("::") || Sees("->")) {
      ++end;
    }
    tokens.push_back({Take(end), line});
  }

  const std::string& source_;
  std::size_t at_ = 0, line_ = 1;
  bool starts_line_ = true;
};

}  // namespace

bool Token::IsWord() const { return !text.empty() && IsPartOfWord(text[0]); }

std::vector<Token> Tokenize(const std::string& source) {
  Scanner scanner(source);
  scanner.Run();
  return std::move(scanner.tokens);
}

std::vector<Token> StringLiterals(const std::string& source) {
  Scanner scanner(source);
  scanner.Run();
  return std::move(scanner.strings);
}

}  // namespace flextip
