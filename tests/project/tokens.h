// C++ source as words and signs, for the checks of the project itself.
#pragma once

#include <string>
#include <vector>

namespace flextip {

struct Token {
  std::string text;  ///< a literal keeps its opening quote only: its text is never code
  std::size_t line = 1;

  bool IsWord() const;
};

/// Returns the tokens of `source`, without comments and lines of the preprocessor. "::" and "->"
/// are one token, other signs a token each.
std::vector<Token> Tokenize(const std::string& source);

/// Returns the string literals of `source`, without their quotes, comments left out.
std::vector<Token> StringLiterals(const std::string& source);

}  // namespace flextip
