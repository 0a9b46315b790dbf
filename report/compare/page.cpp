// The page of flextip compare.
#include "report/pages.h"
#include "report/report.h"
#include "report/summary_parts.h"

namespace flextip::report {

void WriteCompareReport(const std::filesystem::path& folder) {
  Report report = BeginPage(folder, "Results side by side");
  report.AddFigureFile(folder / "figures.json", "Figures");
  report.Write(folder / "report.html");
}

}  // namespace flextip::report
