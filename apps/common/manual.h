// The program's commands and options as texts for other programs: man pages, shell completion.
#pragma once

#include <CLI/CLI.hpp>
#include <map>
#include <string>

namespace flextip {

/// Returns a man page of section 1 for `app` and for each command below it: file name ("flextip.1",
/// "flextip-track.1") to text in roff's man macros. `date` as on the pages, "2026-11-23".
std::map<std::string, std::string> ManPages(const CLI::App& app, const std::string& date);

/// Returns a script for bash (and zsh after bashcompinit) that completes commands and options, and
/// files elsewhere.
std::string CompletionScript(const CLI::App& app);

}  // namespace flextip
