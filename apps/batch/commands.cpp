#include "apps/batch/commands.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>

#include "core/error.h"

namespace flextip {
namespace {

// Each takes an input first and writes a folder with -o.
constexpr std::array<std::string_view, 10> kCommands{"align",    "check", "detect",  "diagnose",
                                                     "estimate", "map",   "predict", "replay",
                                                     "simulate", "track"};
// So does each command below these.
constexpr std::array<std::string_view, 2> kFamilies{"calibrate", "import"};

template <class List>
bool Holds(const List& list, const std::string& word) {
  return std::find(list.begin(), list.end(), word) != list.end();
}

}  // namespace

std::vector<std::string> TakeBatchCommand(std::vector<std::string>& words) {
  const auto take = [&](std::ptrdiff_t count) {
    std::vector<std::string> command(words.begin(), words.begin() + count);
    words.erase(words.begin(), words.begin() + count);
    return command;
  };
  if (!words.empty() && Holds(kCommands, words[0])) return take(1);
  if (!words.empty() && Holds(kFamilies, words[0])) {
    if (words.size() < 2) throw InputError(fmt::format("{}: no command of it was given", words[0]));
    return take(2);
  }
  throw InputError(fmt::format("found the command '{}', expected one of {}, or one of {}",
                               words.empty() ? "" : words[0], fmt::join(kCommands, ", "),
                               fmt::join(kFamilies, ", ")));
}

void RefuseBatchOptions(const std::vector<std::string>& options, const std::string& file,
                        long line) {
  for (const std::string& option : options) {
    const std::string name = option.substr(0, option.find('='));
    const bool out = name == "--output" || (option.starts_with("-o") && !option.starts_with("--"));
    if (!out && name != "--resume" && name != "--force" && name != "--quiet" && name != "-q")
      continue;
    const std::string what =
        fmt::format("found {} for the items, expected none: the batch sees to that", option);
    throw file.empty() ? InputError(what) : InputError::At(file, line, what);
  }
}

}  // namespace flextip
