#include "apps/common/command_paths.h"

#include <set>
#include <sstream>

#include "core/shell_text.h"

namespace flextip {
namespace {

const std::set<std::string> kTakeTracked{"align", "calibrate", "diagnose", "estimate", "predict"};
const std::set<std::string> kTakeCalibrations{"align",    "calibrate", "check", "diagnose",
                                              "estimate", "predict",   "track"};
// They find camera and collar themselves.
const std::set<std::string> kTakeNothing{"camera", "stereo", "hand-eye"};

std::vector<std::string> WordsOf(const std::string& command) {
  std::istringstream in(command);
  std::vector<std::string> words;
  for (std::string word; in >> word;) words.push_back(word);
  return words;
}

}  // namespace

std::string CommandPaths::Fill(const std::string& command) const {
  const std::vector<std::string> words = WordsOf(command);
  if (words.size() < 3) return command;
  const bool nothing = words[1] == "calibrate" && kTakeNothing.contains(words[2]);
  const bool has_tracked = command.find(" --tracked ") != std::string::npos;
  std::string filled;
  for (const std::string& word : words) {
    if (!filled.empty()) filled += ' ';
    filled += FillPlaceholders(word, {{"RECORDING", recording.string()},
                                      {"PICTURE", picture.string()},
                                      {"RESULT", result.string()},
                                      {"MODEL", model.string()}});
    if (word != "RECORDING" || nothing) continue;
    if (!tracked.empty() && !has_tracked && kTakeTracked.contains(words[1]))
      filled += " --tracked " + ShellQuoted(tracked.string());
    if (!kTakeCalibrations.contains(words[1])) continue;
    for (const auto& file : calibrations) filled += " --calibration " + ShellQuoted(file.string());
  }
  return filled;
}

}  // namespace flextip
