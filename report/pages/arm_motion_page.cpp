// The page of a simulated arm: its streams over time.
#include <algorithm>
#include <string>
#include <vector>

#include "report/page_end.h"
#include "report/pages.h"
#include "report/stream_figures.h"
#include "report/summary_parts.h"

namespace flextip::report {

void WriteArmMotionReport(const std::filesystem::path& folder) {
  Report report = TitledPage(folder, "Simulated arm");
  report.AddWarnings(WarningsNotSaid(folder));
  for (const char* stream : {"joints_command0", "joints0", "joints_seen0", "torque0", "pose0"}) {
    if (std::filesystem::exists(folder / stream / "data.csv"))
      report.AddFigures(StreamFigures(folder / stream));
  }
  report.Write(folder / "report.html");
}

}  // namespace flextip::report
