#include "tests/project/doc_rules.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <fstream>
#include <iterator>
#include <regex>
#include <set>
#include <sstream>

namespace flextip {
namespace {

namespace fs = std::filesystem;

bool IsPage(const std::string& path) { return path.ends_with(".md"); }
bool IsCode(const std::string& path) { return path.ends_with(".h") || path.ends_with(".cpp"); }

std::vector<std::string> LinesOf(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

/// All matches of `pattern`, which holds `fixed`: lines without that are not searched.
std::vector<std::smatch> Matches(const std::string& line, const std::string& fixed,
                                 const std::regex& pattern) {
  if (line.find(fixed) == line.npos) return {};
  return {std::sregex_iterator(line.begin(), line.end(), pattern), std::sregex_iterator()};
}

/// Characters, not bytes: the bytes of UTF-8 that begin one.
std::size_t Characters(const std::string& line) {
  return std::size_t(std::count_if(line.begin(), line.end(), [](char c) {
    return (static_cast<unsigned char>(c) & 0xC0) != 0x80;
  }));
}

/// The lines of a page that are text: empty in place of code blocks.
std::vector<std::string> WithoutCode(const std::string& page) {
  std::vector<std::string> lines = LinesOf(page);
  bool code = false;
  for (auto& line : lines) {
    const bool fence =
        line.find_first_not_of(' ') == line.find("```") && line.find("```") != line.npos;
    if (fence) code = !code;
    if (fence || code) line.clear();
  }
  return lines;
}

/// The name by which a link reaches a heading, as web sites of repositories make it.
std::string Anchor(const std::string& heading) {
  static const std::regex link(R"(\[([^\]]*)\]\([^)]*\))");
  std::string anchor;
  for (const char c : std::regex_replace(heading, link, "$1")) {
    const auto byte = static_cast<unsigned char>(c);
    if (std::isalnum(byte) || c == '-' || c == '_') anchor += char(std::tolower(byte));
    if (c == ' ') anchor += '-';
  }
  return anchor;
}

std::set<std::string> AnchorsOf(const std::string& page) {
  std::set<std::string> anchors;
  for (const auto& line : WithoutCode(page)) {
    const auto text = line.find_first_not_of('#');
    if (text == 0 || text == line.npos || line[text] != ' ') continue;
    anchors.insert(Anchor(line.substr(text + 1)));
  }
  return anchors;
}

bool IsThere(const ProjectTexts& texts, const std::string& path) {
  if (path == "." || texts.contains(path)) return true;
  const auto inside = texts.lower_bound(path + "/");
  return inside != texts.end() && inside->first.starts_with(path + "/");
}

/// Why the link `target` on `page` leads nowhere; empty where it does not.
std::string LinkComplaint(const ProjectTexts& texts, const std::string& page,
                          const std::string& target) {
  static const std::regex elsewhere("[a-z]+:.*");
  if (std::regex_match(target, elsewhere)) return "";
  const auto hash = target.find('#');
  const std::string file = target.substr(0, hash);
  const std::string path =
      file.empty() ? page
                   : (fs::path(page).parent_path() / file).lexically_normal().generic_string();
  const std::string bare = path.ends_with('/') ? path.substr(0, path.size() - 1) : path;
  if (!IsThere(texts, bare)) return "there is no " + bare;
  if (hash == target.npos || !IsPage(bare)) return "";
  const std::string anchor = target.substr(hash + 1);
  return AnchorsOf(texts.at(bare)).contains(anchor) ? ""
                                                    : fmt::format("{} has no #{}", bare, anchor);
}

void AddLongLines(const std::string& path, const std::vector<std::string>& lines,
                  std::vector<std::string>& found) {
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const auto first = std::min(lines[i].find_first_not_of(' '), lines[i].size());
    const bool table = IsPage(path) && (lines[i].compare(first, 1, "|") == 0 ||
                                        lines[i].compare(first, 2, "![") == 0);
    const bool one_link =
        lines[i].find("](") != std::string::npos && lines[i].find(' ', first) == std::string::npos;
    if (table || one_link || Characters(lines[i]) <= 100) continue;
    found.push_back(fmt::format("{}:{}: {} characters", path, i + 1, Characters(lines[i])));
  }
}

/// `code` with string literals that stand side by side joined, and quotes inside them bare.
std::string WithJoinedStrings(const std::string& code) {
  std::string joined;
  for (std::size_t i = 0; i < code.size(); ++i) {
    if (code.compare(i, 2, "\\\"") == 0) continue;  // the quote follows by itself
    const auto next = code[i] == '"' ? code.find_first_not_of(" \n", i + 1) : code.npos;
    if (next != code.npos && next > i + 1 && code[next] == '"') {
      i = next;
    } else {
      joined += code[i];
    }
  }
  return joined;
}

/// The sources of the project, but for tests and benches, which do not talk to users.
std::string SourcesOf(const ProjectTexts& texts) {
  static const std::set<std::string> others{"tests", "bench"};
  std::string sources;
  for (const auto& [path, text] : texts) {
    if (!IsCode(path) || others.contains(path.substr(0, path.find('/')))) continue;
    sources += WithJoinedStrings(text) + '\n';
  }
  return sources;
}

std::vector<std::string> FixedParts(const std::string& message) {
  std::vector<std::string> parts;
  const std::string varies = "…";
  for (std::size_t at = 0; at <= message.size();) {
    const auto end = std::min(message.find(varies, at), message.size());
    const std::string part = message.substr(at, end - at);
    const auto first = part.find_first_not_of(' ');
    if (first != part.npos)
      parts.push_back(part.substr(first, part.find_last_not_of(' ') + 1 - first));
    at = end + varies.size();
  }
  return parts;
}

}  // namespace

ProjectTexts ReadProjectTexts(const fs::path& root) {
  static const std::set<std::string> skipped{"build", "out", "node_modules", ".git"};
  static const std::set<std::string> read{".md", ".h", ".cpp", ".txt", ".cmake", ".yaml", ".js"};
  ProjectTexts texts;
  for (auto entry = fs::recursive_directory_iterator(root); entry != end(entry); ++entry) {
    if (entry->is_directory()) {
      if (skipped.contains(entry->path().filename().string())) entry.disable_recursion_pending();
      continue;
    }
    std::string& text = texts[entry->path().lexically_relative(root).generic_string()];
    if (!read.contains(entry->path().extension().string())) continue;
    std::ifstream file(entry->path());
    text.assign(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>());
  }
  return texts;
}

std::vector<std::string> BrokenLinks(const ProjectTexts& texts) {
  static const std::regex link(R"(\]\(([^)\s]+)\))");
  static const std::regex mention(R"(\bdocs/[A-Za-z0-9_./-]*[A-Za-z0-9_])");
  std::vector<std::string> broken;
  for (const auto& [path, text] : texts) {
    if (path.starts_with("tests/project/")) continue;  // breaks links on purpose
    const std::vector<std::string> lines = IsPage(path) ? WithoutCode(text) : LinesOf(text);
    for (std::size_t i = 0; i < lines.size(); ++i) {
      if (IsPage(path)) {
        for (const auto& match : Matches(lines[i], "](", link)) {
          const std::string why = LinkComplaint(texts, path, match[1]);
          if (!why.empty()) broken.push_back(fmt::format("{}:{}: {}", path, i + 1, why));
        }
      }
      for (const auto& match : Matches(lines[i], "docs/", mention)) {
        if (IsThere(texts, match.str())) continue;
        broken.push_back(fmt::format("{}:{}: there is no {}", path, i + 1, match.str()));
      }
    }
  }
  return broken;
}

std::vector<std::string> LongLines(const ProjectTexts& texts) {
  std::vector<std::string> found;
  for (const auto& [path, text] : texts) {
    if (IsPage(path)) AddLongLines(path, WithoutCode(text), found);
    if (IsCode(path)) AddLongLines(path, LinesOf(text), found);
  }
  return found;
}

std::vector<std::string> UnknownMessages(const ProjectTexts& texts, const std::string& page) {
  static const std::regex quoted("`([^`]+)`");
  const std::string sources = SourcesOf(texts);
  std::vector<std::string> unknown;
  for (const auto& line : LinesOf(texts.at(page))) {
    if (!line.starts_with("| `")) continue;
    const std::string cell = line.substr(0, line.find(" | "));
    for (const auto& match : Matches(cell, "`", quoted)) {
      for (const auto& part : FixedParts(match[1])) {
        if (sources.find(part) != sources.npos) continue;
        unknown.push_back(fmt::format("\"{}\" of \"{}\"", part, match[1].str()));
      }
    }
  }
  return unknown;
}

std::map<std::string, std::set<std::string>> ArrowTable(const ProjectTexts& texts,
                                                        const std::string& page) {
  static const std::regex row(R"(\| `([a-z_/]+)/` \|[^|]*\| ([^|]*) \|[^|]*\|)");
  static const std::regex aside(R"(\([^)]*\))");
  static const std::regex name("[a-z_/]+");
  std::map<std::string, std::set<std::string>> arrows;
  for (const auto& line : LinesOf(texts.at(page))) {
    std::smatch cells;
    if (!std::regex_match(line, cells, row)) continue;
    const std::string used = std::regex_replace(cells[2].str(), aside, "");
    std::set<std::string>& names = arrows[cells[1]];
    for (const auto& match : Matches(used, "", name)) names.insert(match.str());
  }
  return arrows;
}

std::vector<std::string> UnknownExamples(const ProjectTexts& texts, const std::string& page) {
  std::set<std::string> examples;
  for (const auto& [path, text] : texts) {
    if (path.starts_with("examples/") && IsCode(path)) examples.insert(text);
  }
  const std::string &text = texts.at(page), fence = "```", opening = "```cpp\n";
  std::vector<std::string> unknown;
  for (auto at = text.find(opening); at != text.npos; at = text.find(opening, at)) {
    at += opening.size();
    const std::string block = text.substr(at, text.find(fence, at) - at);
    if (!examples.contains(block)) unknown.push_back(block.substr(0, block.find('\n')));
  }
  return unknown;
}

}  // namespace flextip
