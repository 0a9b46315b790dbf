// The options of a plan of the next motion.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <vector>

#include "diagnosis/planning/plan.h"

namespace flextip {

struct MotionOptions {
  bool plan = false;
  diagnosis::MotionLimits limits;
  std::vector<double> inserted_m;
  bool no_weight = false;

  diagnosis::MotionLimits Within() const;
  /// Returns the limits where a plan is asked for.
  std::optional<diagnosis::MotionLimits> Limits() const;
};

/// Adds --plan-motion and its limits.
void AddMotionOptions(CLI::App& command, MotionOptions& options);
/// Adds the limits, which need `plan`.
void AddMotionLimits(CLI::App& command, MotionOptions& options, CLI::Option* plan);

}  // namespace flextip
