// The folder a command writes its results to.
#pragma once

#include <chrono>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "apps/common/command_paths.h"
#include "apps/common/interruption.h"

namespace flextip {

struct OutputOptions {
  bool force = false;                              ///< replace a folder that holds something
  std::vector<std::filesystem::path> inputs = {};  ///< inputs of the command: never replaced
  bool resume = false;      ///< continue an interrupted run, where one was left
  bool in_place = false;    ///< grows at NAME itself, and stays there whatever happens
  CommandPaths paths = {};  ///< for the next step's command; `result` is set by OutputFolder
};

/// Results are written to `folder()`, NAME.partial-PID beside NAME, which becomes NAME with Commit.
/// What was not committed is removed, by Ctrl-C too, but for a program that was killed: nothing
/// half-written ever stands under NAME.
///
///   OutputFolder output("out", "track", {.force = force, .inputs = {recording}});
///   ... write below output.folder(), output.Warn("...") ...
///   output.WriteSummary({{"frames", 8}});
///   output.Commit();
class OutputFolder {
 public:
  /// Throws InputError where NAME is a file or a folder that is not empty (without `force`), where
  /// replacing it would delete an input, the working folder, the home folder or a recording without
  /// a summary (which no command made), and where no folder can be made there.
  OutputFolder(const std::filesystem::path& name, const std::string& command,
               const OutputOptions& options = {});
  ~OutputFolder();
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

  /// Where to write until Commit; NAME itself after it.
  const std::filesystem::path& folder() const { return folder_; }
  /// NAME, as an absolute path.
  const std::filesystem::path& name() const { return name_; }
  /// The paths of commands to copy; `result` is NAME as it was given.
  const CommandPaths& paths() const { return paths_; }

  /// Whether an interrupted run's files are in folder().
  bool resumed() const { return resumed_; }
  /// From now on folder() stays when the command fails: a later run can take it over.
  void KeepUnfinished() { keep_ = true; }
  /// From now on folder() stays when the command is interrupted, and the message says how to go on.
  void KeepInterrupted() { interruption_->Keep(); }
  /// From now on the first interrupt (Ctrl-C) only sets StopRequested.
  void OnlyNoteInterrupt() { interruption_->OnlyNote(); }
  bool StopRequested() const { return interruption_->Requested(); }

  /// A line for the summary's `warnings`.
  void Warn(const std::string& warning) { warnings_.push_back(warning); }
  void Warn(const std::vector<std::string>& warnings) {
    warnings_.insert(warnings_.end(), warnings.begin(), warnings.end());
  }
  const std::vector<std::string>& warnings() const { return warnings_; }
  /// What the check of the input found (FindingsJson): the summary's `findings`, and first on the
  /// page.
  void Beware(nlohmann::json findings) { findings_ = std::move(findings); }

  /// Writes summary.json: the object `results` with `command`, `version`, `typed` (the command
  /// line), `date` (UTC), `inputs`, `output` (NAME), `seconds` since the constructor, `warnings`
  /// (those in `results` first) and `findings`, where there are any. A `verdict` in `results` gets
  /// the paths into its `command`. Throws WorkError where the disk refuses, and where
  /// a number in `results` is NaN or infinite, which JSON cannot hold.
  void WriteSummary(nlohmann::ordered_json results) const;

  /// Makes the folder NAME. Throws WorkError where the disk refuses or another program has put
  /// something there in the meantime.
  void Commit();

 private:
  bool TakeOver() const;
  void RefuseToReplace(const std::vector<std::filesystem::path>& inputs) const;

  std::filesystem::path name_;
  std::filesystem::path folder_;
  std::string command_;
  CommandPaths paths_;
  bool force_;
  bool committed_ = false, resumed_ = false, keep_ = false;
  std::vector<std::string> warnings_;
  std::vector<std::filesystem::path> inputs_;
  bool in_place_ = false;
  std::optional<Interruption> interruption_;  // until committed
  nlohmann::json findings_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace flextip
