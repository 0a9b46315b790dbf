#include "apps/common/input/recording_input.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "apps/common/input/input_check.h"

namespace flextip {

void AddRecordingInput(CLI::App& command, RecordingInput& input) {
  command.add_option("recording", input.recording, "Folder of the recording")
      ->required()
      ->type_name("RECORDING");
  command.add_option("-o,--output", input.out, "Folder for the results")
      ->required()
      ->type_name("OUT");
  command.add_option("--tracked", input.tracked,
                     "Take the tip from this result of flextip track instead of vision0");
  AddCalibrationOption(command, input.calibrations);
  AddNoCheckOption(command, input.no_check);
}

std::vector<std::filesystem::path> RecordingInput::Files() const {
  std::vector<std::filesystem::path> files = calibrations;
  files.push_back(recording);
  if (!tracked.empty()) files.push_back(tracked);
  return files;
}

CommandPaths RecordingInput::Paths() const {
  return {.recording = recording, .tracked = tracked, .calibrations = calibrations};
}

std::string InputRead::NotUsed() const {
  std::vector<std::string> names;
  const auto add = [&](bool there, const char* name) {
    if (there) names.emplace_back(name);
  };
  const bool seen = recording.vision0.has_value();  // with tips the camera's pose counts
  add(recording.cam0 && !seen, "cam0");
  add(recording.cam1.has_value(), "cam1");
  add(recording.command0.has_value(), "command0");
  add(recording.tags0 && !seen, "tags0");
  return fmt::to_string(fmt::join(names, ", "));
}

InputRead ReadInput(const RecordingInput& input) {
  InputRead read{ReadCalibrated(input.recording,
                                {.calibrations = input.calibrations, .tracked = input.tracked}),
                 {}};
  if (input.tracked.empty()) return read;
  for (const std::string& name : NotTrackedWith(input.tracked, read.calibrations)) {
    read.warnings.push_back(
        fmt::format("{}: the tips were tracked without {}", input.tracked.string(), name));
  }
  return read;
}

InputRead ReadInput(const RecordingInput& input, const plausibility::CommandUse& use, bool quiet) {
  InputRead read = ReadInput(input);
  read.findings = CheckInput({input.no_check, quiet}, use, read.recording);
  return read;
}

}  // namespace flextip
