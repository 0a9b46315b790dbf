#include "tests/project/draw_rules.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

#include "tests/project/tokens.h"

namespace flextip {
namespace {

using Words = std::set<std::string>;
using Tokens = std::vector<Token>;

/// Returns the place of the sign that closes the bracket at `open`; tokens.size() where none does.
std::size_t Close(const Tokens& tokens, std::size_t open) {
  int depth = 0;
  for (std::size_t i = open; i < tokens.size(); ++i) {
    const std::string& text = tokens[i].text;
    if (text == "(" || text == "[" || text == "{") ++depth;
    if (text == ")" || text == "]" || text == "}") --depth;
    if (depth == 0) return i;
  }
  return tokens.size();
}

bool Is(const Tokens& tokens, std::size_t i, const std::string& text) {
  return i < tokens.size() && tokens[i].text == text;
}

/// Whether a call's arguments open at `i`: behind a name, a template's arguments, another call.
bool OpensCall(const Tokens& tokens, std::size_t i) {
  static const Words kNoCalls{"if", "for", "while", "switch", "return", "catch", "sizeof"};
  if (!Is(tokens, i, "(") || i == 0) return false;
  const Token& before = tokens[i - 1];
  if (before.IsWord()) return !kNoCalls.contains(before.text);
  return before.text == ">" || before.text == ")" || before.text == "]";
}

/// Returns the names declared as generators: "std::mt19937& rng", "Rng rng_;".
Words Generators(const Tokens& tokens) {
  static const Words kTypes{"mt19937", "mt19937_64", "Rng"};
  Words names;
  for (std::size_t i = 0; i + 1 < tokens.size(); ++i) {
    if (!kTypes.contains(tokens[i].text)) continue;
    const std::size_t name = Is(tokens, i + 1, "&") ? i + 2 : i + 1;
    if (name < tokens.size() && tokens[name].IsWord()) names.insert(tokens[name].text);
  }
  return names;
}

/// Returns where the lambda that opens with "[" at `i` has its body's braces; {i, i} for no lambda.
std::pair<std::size_t, std::size_t> Body(const Tokens& tokens, std::size_t i, std::size_t end) {
  if (!Is(tokens, i, "[") || (i > 0 && (tokens[i - 1].IsWord() || tokens[i - 1].text == "]")))
    return {i, i};
  std::size_t at = Close(tokens, i) + 1;
  if (Is(tokens, at, "(")) at = Close(tokens, at) + 1;
  while (at < end && !Is(tokens, at, "{") && !Is(tokens, at, ";") && !Is(tokens, at, ",")) ++at;
  return at < end && Is(tokens, at, "{") ? std::pair{at, Close(tokens, at)} : std::pair{i, i};
}

/// What draws in one file: generators, and lambdas that call something with them.
struct Drawing {
  Words generators, lambdas;

  /// Whether anything between `begin` and `end` draws when it is evaluated.
  bool In(const Tokens& tokens, std::size_t begin, std::size_t end) const {
    for (std::size_t i = begin; i < end; ++i) {
      if (const auto [open, close] = Body(tokens, i, end); open != i) {
        i = close;
      } else if (OpensCall(tokens, i)) {
        if (i > begin && lambdas.contains(tokens[i - 1].text)) return true;
        const std::size_t last = Close(tokens, i);
        for (std::size_t k = i + 1; k < last; ++k)
          if (generators.contains(tokens[k].text)) return true;
      }
    }
    return false;
  }
};

Drawing DrawingOf(const Tokens& tokens, const Words& members) {
  Drawing drawing{Generators(tokens), {}};
  drawing.generators.insert(members.begin(), members.end());
  for (std::size_t i = 0; i + 2 < tokens.size(); ++i) {
    if (!tokens[i].IsWord() || !Is(tokens, i + 1, "=") || !Is(tokens, i + 2, "[")) continue;
    const auto [open, close] = Body(tokens, i + 2, tokens.size());
    if (open != i + 2 && drawing.In(tokens, open + 1, close))
      drawing.lambdas.insert(tokens[i].text);
  }
  return drawing;
}

/// Returns how many arguments of the call that opens at `open` draw.
int DrawingArguments(const Tokens& tokens, std::size_t open, const Drawing& drawing) {
  const std::size_t close = Close(tokens, open);
  int drawn = 0;
  std::size_t begin = open + 1;
  for (std::size_t i = begin; i <= close; ++i) {
    if (i < close && (tokens[i].text == "(" || tokens[i].text == "[" || tokens[i].text == "{")) {
      i = Close(tokens, i);
    } else if (i == close || tokens[i].text == ",") {
      drawn += drawing.In(tokens, begin, i) ? 1 : 0;
      begin = i + 1;
    }
  }
  return drawn;
}

}  // namespace

std::vector<std::string> UnorderedDraws(const SourceTree& tree) {
  std::map<std::string, Tokens> files;
  Words members;
  for (const auto& [path, text] : tree) {
    const Tokens& tokens = files[path] = Tokenize(text);
    for (const std::string& name : Generators(tokens))
      if (name.ends_with("_")) members.insert(name);
  }
  std::vector<std::string> found;
  for (const auto& [path, tokens] : files) {
    const Drawing drawing = DrawingOf(tokens, members);
    if (drawing.generators.empty()) continue;
    for (std::size_t i = 1; i < tokens.size(); ++i) {
      if (!OpensCall(tokens, i)) continue;
      const int drawn = DrawingArguments(tokens, i, drawing);
      if (drawn < 2) continue;
      found.push_back(fmt::format("{}:{}: {}(...) draws in {} arguments", path, tokens[i].line,
                                  tokens[i - 1].text, drawn));
    }
  }
  return found;
}

}  // namespace flextip
