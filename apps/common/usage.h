// What the program says of a command line that it does not understand.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace flextip {

/// Returns `arguments` (without the program's name) with `help [COMMAND...]` and `version` as the
/// options that they stand for.
std::vector<std::string> WithHelpAndVersion(std::vector<std::string> arguments);

/// Returns one line: the reason, a word that may have been meant, and the help to read. What is
/// unknown comes before what is missing. `app` has parsed and thrown `error`.
std::string UsageMessage(const CLI::App& app, const CLI::ParseError& error);

/// Returns the word of `known` nearest to `word`, or nothing where none is like it: more than a
/// third of its letters, and more than one, would have to be added, left out, changed or swapped.
std::string NearestWord(const std::string& word, const std::vector<std::string>& known);

}  // namespace flextip
