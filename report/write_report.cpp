// The page of any result folder, by the command that made it.
#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/error.h"
#include "report/pages.h"
#include "report/result_files.h"
#include "report/summary_parts.h"

namespace flextip::report {
namespace {

namespace fs = std::filesystem;

/// An arm with joints has no path of a tip.
bool IsOfArm(const fs::path& folder) { return fs::exists(folder / "arm.yaml"); }

/// A robot that moved until it knew has the page of what it found, an arm that of its streams.
void WritePageOfSimulate(const fs::path& folder) {
  if (fs::exists(folder / "diagnosis.json")) return WriteDiagnoseReport(folder);
  IsOfArm(folder) ? WriteArmMotionReport(folder) : WriteSimulateReport(folder);
}

struct CommandPage {
  const char* command;  ///< or its first word
  void (*write)(const fs::path& folder);
  std::vector<const char*> needs = {};  ///< files without which the page would be empty
};

const std::vector<CommandPage>& Pages() {
  static const std::vector<CommandPage> pages{
      {"simulate", WritePageOfSimulate},
      {"track", WriteTrackReport, {"vision0/data.csv", "frames.csv"}},
      {"estimate", WriteEstimateReport, {"state0/data.csv"}},
      {"excerpt", WriteExcerptReport, {"stop.csv"}},
      {"check", WriteCheckReport},
      {"control", WriteControlReport, {"session0/cycles.csv"}},
      {"shape", WriteShapeReport, {"shapes.csv"}},
      {"detect", WriteDetectReport, {"tags.csv"}},
      {"calibrate", WriteCalibrateReport},
      {"align", WriteCalibrateReport, {"figures.json"}},
      {"compare", WriteCompareReport, {"figures.json"}},
      {"replay", WriteCompareReport, {"figures.json"}},
      {"batch", WriteBatchReport, {"figures.json", "table.csv"}},
      {"board", WriteCalibrateReport},
      {"collar", WriteCalibrateReport, {"figures.json", "drawing.png"}},
      {"diagnose", WriteDiagnoseReport, {"diagnosis.json", "residuals.csv"}},
      {"import", WriteImportReport, {"recording.yaml"}},
      {"map", WriteMapReport, {"figures.json", "table.csv"}},
      {"predict", WritePredictReport, {"residuals.csv"}},
      {"reproduce", WriteReproduceReport, {"figures.json", "table.csv"}}};
  return pages;
}

/// A served robot has no path of its own.
bool WasServed(const fs::path& folder) {
  return ReadBytes(folder / "summary.json").find("\"served\"") != std::string::npos;
}

/// A run's deviation.csv lies in the folder itself or, of several controllers, in one of each.
bool HasDeviations(const fs::path& folder) {
  if (fs::exists(folder / "deviation.csv")) return true;
  return std::any_of(fs::directory_iterator(folder), fs::directory_iterator(),
                     [](const auto& at) { return fs::exists(at.path() / "deviation.csv"); });
}

}  // namespace

void WriteReport(const fs::path& folder) {
  const auto refuse = [&](const std::string& what) {
    throw InputError::At(folder.string(), 0, what);
  };
  if (!fs::exists(folder / "summary.json")) {
    refuse("no summary.json, expected a folder that a command of flextip has written");
  }
  const std::string command = CommandOf(folder);
  const std::string first_word = command.substr(0, command.find(' '));
  const auto page = std::find_if(Pages().begin(), Pages().end(), [&](const CommandPage& candidate) {
    return candidate.command == first_word;
  });
  if (page == Pages().end()) refuse(fmt::format("no page is known for the command {}", command));
  for (const char* file : page->needs) {
    if (!fs::exists(folder / file)) refuse(fmt::format("no {}, the page needs it", file));
  }
  if (first_word == "simulate" && !HasDeviations(folder) && !WasServed(folder) &&
      !IsOfArm(folder)) {
    refuse("no deviation.csv, the page needs it");
  }
  try {
    page->write(folder);
  } catch (const nlohmann::json::exception&) {
    refuse("summary.json or another file of JSON in it is damaged: run the command again");
  }
}

}  // namespace flextip::report
