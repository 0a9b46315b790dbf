// flextip-demo: those commands of flextip that scripts/demo runs. Built in half the time.
#include "apps/common/program.h"

namespace flextip {
namespace {

void AddCommands(CLI::App& app, AppContext& context) {
  AddSimulate(app, context);
  AddTrack(app, context);
}

}  // namespace
}  // namespace flextip

int main(int argc, char** argv) {
  return flextip::RunProgram({"flextip-demo", "Two commands of flextip, for scripts/demo",
                              "All commands are in flextip, which scripts/build builds.\n"},
                             flextip::AddCommands, {argv + 1, argv + argc});
}
