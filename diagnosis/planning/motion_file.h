// A planned motion as a file that `simulate` and `control` run: a section `path` of its own
// (docs/scenarios.md).
#pragma once

#include <filesystem>
#include <string>

#include "diagnosis/planning/plan.h"

namespace flextip::diagnosis {

/// Returns what the plan is for and what it takes, in a sentence or two.
std::string Sentence(const NextMotion& plan);

/// Returns the file's text. The plan must have places.
std::string MotionYaml(const NextMotion& plan);

/// Throws WorkError where the file cannot be written.
void WriteMotion(const std::filesystem::path& file, const NextMotion& plan);

}  // namespace flextip::diagnosis
