#include "apps/calibrate.h"
namespace flextip {
void AddCalibrateEm(CLI::App&, AppContext&) {}
}  // namespace flextip
