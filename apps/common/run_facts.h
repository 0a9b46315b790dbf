// What a summary says of the run: when, how long, by which command line.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace flextip {

/// Keeps the command line for the summaries of this process: `program`, then `arguments`.
void NoteTyped(const std::string& program, const std::vector<std::string>& arguments);
/// Returns it, as a shell takes it.
const std::string& Typed();

/// Returns a command line as a shell takes it.
std::string ShellLine(const std::string& program, const std::vector<std::string>& arguments);

/// Returns the time now, "2026-11-23T18:50:07Z".
std::string DateNow();

/// From now on nothing in this process's summaries depends on the moment, the machine or the place:
/// what measures time goes into `times`, which must outlive the work; there is no date; `typed`
/// stands for the command line, and `result` for the path of the results. Two runs then write the
/// same bytes.
void KeepTimesApart(const std::string& typed, const std::filesystem::path& result,
                    nlohmann::ordered_json& times);

/// Returns how a summary names the folder of the results: as it was given, or as KeepTimesApart
/// says.
std::filesystem::path ResultAsSaid(const std::filesystem::path& given);

/// Adds `seconds`, `date` and `typed` to a summary, or keeps them apart.
void AddRunFacts(double seconds, nlohmann::ordered_json& summary);

}  // namespace flextip
