// flextip simulate --diagnose: the robot moves until its recordings tell the causes apart.
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>

namespace flextip {

struct MotionOptions;

struct DiagnosingCommand {
  std::filesystem::path scenario, out;
  std::shared_ptr<MotionOptions> plan;  ///< limits of the planned motions
  int rounds = 4;
  bool asked = false, force = false;
};

/// Adds --diagnose and the options that need it. Returns --diagnose.
CLI::Option* AddDiagnosingOptions(CLI::App& command, DiagnosingCommand& options);

/// Throws InputError for a scenario that cannot run so, and as DiagnoseInLoop.
void RunDiagnosing(const DiagnosingCommand& options, bool quiet);

}  // namespace flextip
