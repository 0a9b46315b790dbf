#include "tests/project/definitions.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

#include "tests/project/tokens.h"

namespace flextip {
namespace {

using Tokens = std::vector<Token>;
const std::set<std::string> kTypeWords{"struct", "class", "union", "enum"};
const std::set<std::string> kBuiltin{"bool",     "char",  "int",    "long", "float", "double",
                                     "unsigned", "short", "signed", "auto", "void"};

bool Has(const Tokens& tokens, const std::string& text) {
  return std::any_of(tokens.begin(), tokens.end(),
                     [&](const Token& token) { return token.text == text; });
}

/// Returns the index after the bracket that closes the one at `open`.
std::size_t Closed(const Tokens& tokens, std::size_t open) {
  const std::string opening = tokens[open].text;
  const std::string closing = opening == "("   ? ")"
                              : opening == "{" ? "}"
                              : opening == "<" ? ">"
                                               : "]";
  int depth = 0;
  for (std::size_t i = open; i < tokens.size(); ++i) {
    if (tokens[i].text == opening) ++depth;
    if (tokens[i].text == closing && --depth == 0) return i + 1;
  }
  return tokens.size();
}

/// Returns the type of a parameter: without its default and its name.
std::string ParameterType(Tokens tokens) {
  const auto is_default = [](const Token& token) { return token.text == "="; };
  tokens.erase(std::find_if(tokens.begin(), tokens.end(), is_default), tokens.end());
  const auto is_type = [](const Token& token) {
    return token.text != "const" && token.text != "::" && token.text != "typename";
  };
  const auto rest = static_cast<std::size_t>(std::count_if(tokens.begin(), tokens.end(), is_type));
  if (tokens.size() > 1 && tokens.back().IsWord() && !kBuiltin.contains(tokens.back().text) &&
      tokens[tokens.size() - 2].text != "::" && tokens.back().text != "const" && rest > 1)
    tokens.pop_back();
  std::string text;
  for (const Token& token : tokens) text += (text.empty() ? "" : " ") + token.text;
  return text;
}

/// Returns the types of the parameters in the brackets at `open`: "(int, const Pose &)".
std::string ParameterTypes(const Tokens& tokens, std::size_t open) {
  std::vector<std::string> types;
  Tokens parameter;
  int depth = 0;
  for (std::size_t i = open + 1, end = Closed(tokens, open) - 1; i < end; ++i) {
    const std::string& text = tokens[i].text;
    if (text == "(" || text == "{" || text == "[" || text == "<") ++depth;
    if (text == ")" || text == "}" || text == "]" || text == ">") --depth;
    if (text == "," && depth == 0) {
      types.push_back(ParameterType(parameter));
      parameter.clear();
    } else {
      parameter.push_back(tokens[i]);
    }
  }
  if (!parameter.empty()) types.push_back(ParameterType(parameter));
  return fmt::format("({})", fmt::join(types, ", "));
}

/// Reads one file. At namespace scope it collects a statement up to its ';' or its body.
class Reader {
 public:
  explicit Reader(const std::string& text) : tokens_(Tokenize(text)) {}

  std::vector<Definition> Run() {
    while (at_ < tokens_.size()) Next();
    return std::move(found_);
  }

 private:
  void Next() {
    const std::string& text = tokens_[at_].text;
    if (text == ";") {
      statement_.clear();
      ++at_;
    } else if (text == "}") {
      if (!scopes_.empty()) scopes_.pop_back();
      statement_.clear();
      ++at_;
    } else if (text == "(" || text == "[") {
      Copy(Closed(tokens_, at_));
    } else if (text == "{") {
      Open();
    } else {
      Copy(at_ + 1);
    }
  }
  void Copy(std::size_t end) {
    for (; at_ < end; ++at_) statement_.push_back(tokens_[at_]);
  }

  void Open() {
    if (Has(statement_, "namespace")) return OpenNamespace();
    if (!statement_.empty() && statement_[0].text == "extern" && statement_.size() == 2) {
      scopes_.emplace_back("");
      statement_.clear();
      ++at_;
      return;
    }
    const Tokens head = WithoutTemplate();
    if (IsType(head)) {
      Add(TypeName(head), head);
    } else if (IsVariable(head) || IsMemberInitialiser(head)) {
      at_ = Closed(tokens_, at_);  // the statement goes on after it
      statement_.push_back({"{}", 0});
      return;
    } else {
      Add(FunctionName(head), head);
    }
    at_ = Closed(tokens_, at_);
    statement_.clear();
  }
  void OpenNamespace() {
    std::string name;  // what stands before it is a macro
    for (const Token& token : statement_) {
      if (token.text == "namespace") {
        name.clear();
      } else if (token.text != "inline") {
        name += token.text;
      }
    }
    scopes_.push_back(name.empty() ? kAnonymous : name);
    statement_.clear();
    ++at_;
  }

  /// Returns the statement without "template <...>" and attributes.
  Tokens WithoutTemplate() const {
    std::size_t first = 0;
    while (first + 1 < statement_.size()) {
      if (statement_[first].text == "template" && statement_[first + 1].text == "<") {
        first = Closed(statement_, first + 1);
      } else if (statement_[first].text == "[") {
        first = Closed(statement_, first);
      } else if (statement_[first].text == "requires") {
        while (first < statement_.size() && statement_[first].text != "(") ++first;
        if (first < statement_.size()) first = Closed(statement_, first);
      } else {
        break;
      }
    }
    return {statement_.begin() + static_cast<std::ptrdiff_t>(first), statement_.end()};
  }
  static bool IsType(const Tokens& head) {
    return !head.empty() && kTypeWords.contains(head[0].text) && !Has(head, "(");
  }
  static bool IsVariable(const Tokens& head) {
    for (std::size_t i = 0; i < head.size(); ++i) {
      if (head[i].text == "operator") return false;
      if (head[i].text == "(") return false;
      if (head[i].text == "=") return true;
    }
    return true;
  }
  /// Returns whether the brace is that of `: member_{...}`, not a constructor's body.
  static bool IsMemberInitialiser(const Tokens& head) {
    int depth = 0;
    bool in_list = false;
    for (std::size_t i = 1; i < head.size(); ++i) {
      if (head[i].text == "(") ++depth;
      if (head[i].text == ")") --depth;
      if (head[i].text == ":" && depth == 0) in_list = true;
    }
    return in_list && (head.back().IsWord() || head.back().text == ">");
  }
  static std::string TypeName(const Tokens& head) {
    std::string name;
    for (std::size_t i = 1; i < head.size(); ++i) {
      if (head[i].text == ":" || head[i].text == "final") break;
      if (head[i].text == "[") {  // an attribute
        i = Closed(head, i) - 1;
      } else if (!kTypeWords.contains(head[i].text)) {
        name += head[i].text;
      }
    }
    return name;
  }
  /// Returns `last`, or the index of the word before "<...>" where that stands at `last`.
  static std::size_t BeforeTemplateArguments(const Tokens& head, std::size_t last) {
    if (head[last].text != ">") return last;
    int depth = 0;
    for (std::size_t i = last; i > 0; --i) {
      if (head[i].text == ">") ++depth;
      if (head[i].text == "<" && --depth == 0) return i - 1;
    }
    return last;
  }
  std::string FunctionName(const Tokens& head) const {
    std::size_t open = 0;
    while (open < head.size() && head[open].text != "(") ++open;
    if (open == 0 || open == head.size() ||
        Has({head.begin(), head.begin() + static_cast<std::ptrdiff_t>(open)}, "static"))
      return "";
    if (head[open - 1].text == "operator" && open + 2 < head.size()) open += 2;  // operator()()
    std::size_t first = open - 1;
    for (std::size_t i = 0; i < open; ++i)
      if (head[i].text == "operator") first = i;
    first = BeforeTemplateArguments(head, first);
    while (first > 0 && (head[first].text == "::" || head[first - 1].text == "::"))
      first = BeforeTemplateArguments(head, first - 1);
    std::string name;
    for (std::size_t i = first; i < open; ++i) name += head[i].text;
    if (name == "main" || name == "catch" || name.empty()) return "";
    const std::size_t after = Closed(head, open);
    name += ParameterTypes(head, open);
    if (after < head.size() && head[after].text == "const") name += " const";
    if (!statement_.empty() && statement_[0].text == "template") name += " template";
    return name;
  }

  void Add(const std::string& name, const Tokens& head) {
    if (name.empty() || std::count(scopes_.begin(), scopes_.end(), kAnonymous) > 0) return;
    std::string full;
    for (const std::string& scope : scopes_)
      if (!scope.empty()) full += scope + "::";
    found_.push_back({full + name, head[0].line});
  }

  inline static const std::string kAnonymous = "(anonymous)";
  Tokens tokens_;
  std::size_t at_ = 0;
  Tokens statement_;
  std::vector<std::string> scopes_;
  std::vector<Definition> found_;
};

}  // namespace

std::vector<Definition> DefinitionsOf(const std::string& text) { return Reader(text).Run(); }

std::vector<std::string> DoubleDefinitions(const SourceTree& tree) {
  std::map<std::string, std::map<std::string, std::size_t>> places;
  for (const auto& [path, text] : tree)
    for (const Definition& definition : DefinitionsOf(text))
      places[definition.name].try_emplace(path, definition.line);
  std::vector<std::string> doubles;
  for (const auto& [name, files] : places) {
    if (files.size() < 2) continue;
    std::vector<std::string> where;
    for (const auto& [path, line] : files) where.push_back(fmt::format("{}:{}", path, line));
    doubles.push_back(fmt::format("{}: {}", name, fmt::join(where, ", ")));
  }
  return doubles;
}

}  // namespace flextip
