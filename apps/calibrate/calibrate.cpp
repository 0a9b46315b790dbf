// flextip calibrate: the parameters of sensors and instrument, one sub-command each.
#include "apps/calibrate/calibrate.h"

#include <CLI/CLI.hpp>

#include "apps/common/commands.h"

namespace flextip {

void AddCalibrate(CLI::App& app, AppContext& context) {
  auto* command = app.add_subcommand("calibrate", "Calibrate sensors and instrument");
  command->require_subcommand(1);
  command->footer("Example:\n  flextip calibrate camera --help\n");
  AddCalibrateCamera(*command, context);
  AddCalibrateStereo(*command, context);
  AddCalibrateHandEye(*command, context);
  AddCalibrateTip(*command, context);
  AddCalibrateEm(*command, context);
  AddCalibrateStrain(*command, context);
  AddCalibrateStiffness(*command, context);
  AddCalibrateBudget(*command, context);
}

}  // namespace flextip
