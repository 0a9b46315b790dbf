// flextip: the program. Exit codes: 0 done, 1 the work failed, 2 wrong usage or unreadable input.
#include "apps/common/program.h"

namespace flextip {
namespace {

void AddCommands(CLI::App& app, AppContext& context) {
  AddAlign(app, context);
  AddBatch(app, context);
  AddBoard(app, context);
  AddCalibrate(app, context);
  AddCheck(app, context);
  AddCollar(app, context);
  AddCompare(app, context);
  AddCompletion(app, context);
  AddControl(app, context);
  AddConvert(app, context);
  AddDetect(app, context);
  AddDiagnose(app, context);
  AddEffect(app, context);
  AddEstimate(app, context);
  AddExport(app, context);
  AddImport(app, context);
  AddMap(app, context);
  AddPredict(app, context);
  AddReplay(app, context);
  AddReport(app, context);
  AddReproduce(app, context);
  AddShape(app, context);
  AddSimulate(app, context);
  AddTrack(app, context);
}

}  // namespace
}  // namespace flextip

int main(int argc, char** argv) {
  return flextip::RunProgram({"flextip", "Control of thin, bending surgical instruments by sight",
                              "Every command explains itself: flextip help COMMAND\n"},
                             flextip::AddCommands, {argv + 1, argv + argc});
}
