// The sub-commands of flextip calibrate, a file each.
#pragma once

#include <CLI/CLI.hpp>

#include "apps/common/commands.h"

namespace flextip {

// As in commands.h, of `calibrate`.
void AddCalibrateCamera(CLI::App& calibrate, AppContext& context);
void AddCalibrateStereo(CLI::App& calibrate, AppContext& context);
void AddCalibrateHandEye(CLI::App& calibrate, AppContext& context);
void AddCalibrateTip(CLI::App& calibrate, AppContext& context);
void AddCalibrateEm(CLI::App& calibrate, AppContext& context);
void AddCalibrateStrain(CLI::App& calibrate, AppContext& context);
void AddCalibrateStiffness(CLI::App& calibrate, AppContext& context);
void AddCalibrateBudget(CLI::App& calibrate, AppContext& context);

}  // namespace flextip
