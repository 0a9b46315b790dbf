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
void WriteWithPictures(const fs::path& folder, const std::string& title,
                       const std::string& heading) {
  Report report = BeginPage(folder, title);
  auto pictures = PicturesIn(folder / "overlay", kPictures);
  const auto beside = PicturesIn(folder, kPictures);
  pictures.insert(pictures.end(), beside.begin(), beside.end());
  AddPictureFiles(report, heading, pictures);
  AddShortTable(report, folder / "shapes.csv", "Shapes");
  report.Write(folder / "report.html");
}

}  // namespace

void WriteEstimateReport(const fs::path& folder) {
  Report report = BeginPage(folder, "Instrument fitted to the sensors");
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
  WriteWithPictures(folder, "Shape of the shaft", "The shaft");
}

void WriteDetectReport(const fs::path& folder) {
  WriteWithPictures(folder, "Tags found in pictures", "What was found");
}

}  // namespace flextip::report
