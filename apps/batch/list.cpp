#include "apps/batch/list.h"

#include <fmt/format.h>
#include <glob.h>

#include <algorithm>
#include <map>
#include <optional>
#include <sstream>

#include "apps/batch/commands.h"
#include "core/error.h"
#include "recording/text/text.h"

namespace flextip {
namespace {

namespace fs = std::filesystem;

constexpr const char* kPlain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789._-";
constexpr std::size_t kLongestName = 200;  // a file's name may have 255 bytes

struct Line {
  ListedItem item;
  long number = 0;  // in the file; 0: of a glob
};

/// The words of a line, as a shell splits it.
class Words {
 public:
  Words(const std::string& line, const std::string& file, long number)
      : line_(line), file_(file), number_(number) {}

  std::vector<std::string> Split() {
    while (at_ < line_.size()) {
      const char c = line_[at_];
      if (c == ' ' || c == '\t' || c == '\r') {
        EndWord();
        ++at_;
      } else if (c == '#' && !word_) {
        break;
      } else if (c == '\'' || c == '"') {
        TakeQuoted(c);
      } else {
        if (c == '\\' && at_ + 1 < line_.size()) ++at_;
        Add(line_[at_++]);
      }
    }
    EndWord();
    return words_;
  }

 private:
  void Add(char c) {
    if (!word_) word_.emplace();
    *word_ += c;
  }
  void EndWord() {
    if (word_) words_.push_back(*word_);
    word_.reset();
  }
  void TakeQuoted(char quote) {
    if (!word_) word_.emplace();
    for (++at_; at_ < line_.size() && line_[at_] != quote; ++at_) {
      if (quote == '"' && line_[at_] == '\\' && at_ + 1 < line_.size()) ++at_;
      Add(line_[at_]);
    }
    if (at_ == line_.size()) {
      throw InputError::At(file_, number_, fmt::format("found no second {}, expected one", quote));
    }
    ++at_;
  }

  const std::string &line_, &file_;
  long number_;
  std::size_t at_ = 0;
  std::optional<std::string> word_;
  std::vector<std::string> words_;
};

std::string Beside(const fs::path& folder, const std::string& path) {
  return (fs::path(path).is_absolute() ? fs::path(path) : folder / path)
      .lexically_normal()
      .string();
}

/// An option's value that names a file beside the list is that file: "tracks/a", "em0=em.csv".
std::string WithPath(const fs::path& folder, const std::string& word) {
  const std::size_t begin = word.find('=') + 1;  // 0 where there is none
  const std::string path = word.substr(begin);
  if (path.empty() || path[0] == '-' || fs::path(path).is_absolute()) return word;
  if (path.find('/') == std::string::npos && path.find('.') == std::string::npos) return word;
  std::error_code error;
  if (!fs::exists(folder / path, error)) return word;
  return word.substr(0, begin) + Beside(folder, path);
}

void CheckName(const std::string& name, const std::string& file, long line) {
  const bool plain = name.find_first_not_of(kPlain) == std::string::npos && !name.empty() &&
                     name[0] != '.' && name.size() <= kLongestName &&
                     name.find(".partial-") == std::string::npos;
  if (plain) return;
  throw InputError::At(
      file, line,
      fmt::format("found the name {}, expected letters, digits and . _ -", Quoted(name)));
}

std::vector<Line> LinesOf(const std::string& file) {
  const fs::path folder = fs::path(file).parent_path();
  std::istringstream text(ReadTextFile(file));
  std::vector<Line> lines;
  long number = 0;
  for (std::string line; std::getline(text, line);) {
    std::vector<std::string> words = Words(line, file, ++number).Split();
    if (words.empty()) continue;
    if (words[0].empty() || words[0][0] == '-' || words[0].starts_with("name=")) {
      throw InputError::At(file, number,
                           fmt::format("found {}, expected a path first", Quoted(words[0])));
    }
    Line one{{"", Beside(folder, words[0]), {}}, number};
    for (auto word = words.begin() + 1; word != words.end(); ++word) {
      if (!word->starts_with("name=")) {
        one.item.options.push_back(WithPath(folder, *word));
        continue;
      }
      one.item.name = word->substr(5);
      CheckName(one.item.name, file, number);
    }
    RefuseBatchOptions(one.item.options, file, number);
    lines.push_back(std::move(one));
  }
  return lines;
}

std::vector<Line> LinesOfGlob(const std::string& pattern) {
  glob_t found{};
  std::vector<Line> lines;
  if (glob(pattern.c_str(), 0, nullptr, &found) == 0) {
    for (std::size_t i = 0; i < found.gl_pathc; ++i) {
      lines.push_back({{"", fs::path(found.gl_pathv[i]).lexically_normal().string(), {}}, 0});
    }
  }
  globfree(&found);
  return lines;
}

/// The last `parts` parts of a path as a name: "day1-take3".
std::string NameOf(const std::string& input, std::size_t parts) {
  fs::path path = fs::path(input).lexically_normal();
  if (!path.has_filename()) path = path.parent_path();
  std::error_code error;
  if (!fs::is_directory(path, error)) path.replace_extension();
  std::string name;
  for (std::size_t i = 0; i < parts && path.has_filename(); ++i, path = path.parent_path()) {
    name = path.filename().string() + (name.empty() ? "" : "-" + name);
  }
  for (char& c : name) {
    if (std::string_view(kPlain).find(c) == std::string_view::npos) c = '_';
  }
  if (name.size() > kLongestName) name = name.substr(name.size() - kLongestName);
  name.erase(0, name.find_first_not_of('.'));
  return name.empty() ? "item" : name;
}

/// Gives a name to each line without one: longer ones where several would be the same.
void GiveNames(std::vector<Line>& lines) {
  std::vector<std::size_t> unnamed;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (lines[i].item.name.empty()) unnamed.push_back(i);
  }
  constexpr std::size_t kMostParts = 8;
  for (std::size_t parts = 1; parts <= kMostParts && !unnamed.empty(); ++parts) {
    for (const std::size_t i : unnamed) lines[i].item.name = NameOf(lines[i].item.input, parts);
    std::map<std::string, int> count;
    for (const Line& line : lines) ++count[line.item.name];
    std::erase_if(unnamed, [&](std::size_t i) { return count[lines[i].item.name] == 1; });
  }
}

}  // namespace

std::vector<ListedItem> ReadBatchList(const std::string& list) {
  std::error_code error;
  const bool glob = list.find_first_of("*?[") != std::string::npos && !fs::exists(list, error);
  if (!glob && fs::is_directory(list, error)) {
    throw InputError::At(list, 0, "is a folder, expected a file of paths, or a glob in quotes");
  }
  std::vector<Line> lines = glob ? LinesOfGlob(list) : LinesOf(list);
  if (lines.empty()) {
    throw InputError::At(list, 0, glob ? "no path is like that" : "holds no path, expected some");
  }
  GiveNames(lines);
  std::map<std::string, long> seen;
  std::vector<ListedItem> items;
  for (Line& line : lines) {
    const auto [first, is_new] = seen.emplace(line.item.name, line.number);
    if (!is_new) {
      throw InputError::At(list, line.number,
                           fmt::format("found the name {} of line {} again, expected another: "
                                       "name=NAME behind the path",
                                       line.item.name, first->second));
    }
    items.push_back(std::move(line.item));
  }
  return items;
}

}  // namespace flextip
