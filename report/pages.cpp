// The pages of estimate, shape and detect.
#include "report/pages.h"

#include <string>

#include "report/page_parts.h"
#include "report/report.h"
#include "report/result_files.h"
#include "report/summary_parts.h"

namespace flextip::report {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kPictures = 6;
constexpr const char* kX = "x (mm)";
constexpr const char* kY = "y (mm)";
constexpr const char* kZ = "z (mm)";
}  // namespace

void WriteEstimateReport(const fs::path& folder) {
  Report report = BeginPage(folder, "Instrument fitted to the sensors");
  if (fs::exists(folder / "figures.json")) report.AddFigureFile(folder / "figures.json");
  const auto data = folder / "state0" / "data.csv";
  if (fs::exists(data)) {
    const auto table = ReadResultTable(data);
    report.AddHeading("State over time");
    const auto path = PathTrace(table, "p_RE", "tip");
    if (!path.x.empty()) {
      report.AddFigure({.title = "Path of the tip",
                        .x_label = kX,
                        .y_label = kY,
                        .z_label = kZ,
                        .traces = {path}});
    }
    AddColumnsOverTime(report, table);
  }
  report.Write(folder / "report.html");
}

void WriteShapeReport(const fs::path& folder) {
  Report report = BeginPage(folder, "Shape of the shaft");
  if (fs::exists(folder / "figures.json")) {  // of a single shape
    report.AddHeading("The shaft");
    report.AddFigureFile(folder / "figures.json");
  }
  AddShortTable(report, folder / "shapes.csv", "Shapes");
  report.Write(folder / "report.html");
}

void WriteDetectReport(const fs::path& folder) {
  Report report = BeginPage(folder, "Tags found in pictures");
  AddPictureFiles(report, "What was found", PicturesIn(folder / "overlay", kPictures));
  report.Write(folder / "report.html");
}

}  // namespace flextip::report
