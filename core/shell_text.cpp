#include "core/shell_text.h"

#include <algorithm>
#include <cctype>

namespace flextip {
namespace {

bool BeginsWith(const std::string& word, const std::string& placeholder) {
  if (!word.starts_with(placeholder)) return false;
  if (word.size() == placeholder.size()) return true;
  const auto next = static_cast<unsigned char>(word[placeholder.size()]);
  return !std::isalnum(next) && next != '_';
}

std::string Filled(const std::string& word, const std::vector<Placeholder>& placeholders) {
  for (const Placeholder& p : placeholders) {
    if (p.path.empty() || !BeginsWith(word, p.word)) continue;
    const std::string before = p.path.starts_with("-") ? "./" : "";
    return ShellQuoted(before + p.path + word.substr(p.word.size()));
  }
  return word;
}

}  // namespace

std::string ShellQuoted(const std::string& argument) {
  constexpr const char* kPlain =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-+=./,:@%";
  if (!argument.empty() && argument.find_first_not_of(kPlain) == std::string::npos) return argument;
  std::string quoted = "'";
  for (const char c : argument) quoted += c == '\'' ? "'\\''" : std::string(1, c);
  return quoted + "'";
}

std::string FillPlaceholders(const std::string& command,
                             const std::vector<Placeholder>& placeholders) {
  std::string filled;
  for (std::size_t at = 0; at <= command.size();) {
    const std::size_t end = std::min(command.find(' ', at), command.size());
    if (at > 0) filled += ' ';
    filled += Filled(command.substr(at, end - at), placeholders);
    at = end + 1;
  }
  return filled;
}

}  // namespace flextip
