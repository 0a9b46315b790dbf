// Commands to copy: arguments as a shell takes them, and words that stand for paths.
#pragma once

#include <string>
#include <vector>

namespace flextip {

/// Returns `argument` as a POSIX shell takes it, in quotes where it needs them.
std::string ShellQuoted(const std::string& argument);

/// A word in a command, in capitals, that stands for a path: RECORDING, RESULT.
struct Placeholder {
  std::string word;
  std::string path;  ///< empty: the word stays
};

/// Returns `command`, words with a space between, with the paths in it. A placeholder counts where
/// a word begins with it: "RESULT/model.yaml", "RESULT-estimate". Such a word is quoted as a whole
/// where a shell needs it; a path that begins like an option gets "./" before it.
std::string FillPlaceholders(const std::string& command,
                             const std::vector<Placeholder>& placeholders);

}  // namespace flextip
