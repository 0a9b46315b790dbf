#include "report/pages.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "report/page_parts.h"
#include "report/report.h"
#include "report/result_files.h"

namespace flextip::report {
namespace {

namespace fs = std::filesystem;

constexpr double kMmPerM = 1000.0;
constexpr std::size_t kPictures = 6;
constexpr const char* kX = "x (mm)";
constexpr const char* kY = "y (mm)";
constexpr const char* kZ = "z (mm)";
/// The models of the controllers in the order of their worth, with their colours.
constexpr std::pair<const char*, const char*> kModelColors[] = {
    {"straight", "#d55e00"}, {"flex", "#0072b2"}, {"rod", "#009e73"}};

/// One controller's run.
struct Run {
  std::string name;  ///< empty where there is one run only
  fs::path folder;
  ResultTable deviation;
};

std::vector<Run> ReadRuns(const fs::path& folder) {
  std::vector<Run> runs;
  if (fs::exists(folder / "deviation.csv")) {
    runs.push_back({"", folder, ReadResultTable(folder / "deviation.csv")});
  }
  for (const auto& sub : FoldersWith(folder, "deviation.csv")) {
    runs.push_back({sub.filename().string(), sub, ReadResultTable(sub / "deviation.csv")});
  }
  const auto rank = [](const Run& run) {
    const auto* it = std::find_if(std::begin(kModelColors), std::end(kModelColors),
                                  [&](const auto& m) { return run.name.starts_with(m.first); });
    return it - std::begin(kModelColors);
  };
  std::stable_sort(runs.begin(), runs.end(),
                   [&](const Run& a, const Run& b) { return rank(a) < rank(b); });
  return runs;
}

/// One colour a model; what is calculated rather than seen is dashed.
void StyleController(PlotTrace& trace) {
  for (const auto& [model, color] : kModelColors) {
    if (trace.name.starts_with(model)) trace.color = color;
  }
  trace.dashed = trace.name.find("calculate") != std::string::npos;
}

void AddDeviations(Report& report, const std::vector<Run>& runs) {
  Plot plot{.title = "Deviation from the desired path",
            .caption =
                "How far the true tip was from where it was wanted. Solid: the tip is "
                "measured; dashed: it is calculated from the model.",
            .x_label = "time (s)",
            .y_label = "deviation (mm)"};
  for (const auto& run : runs) {
    PlotTrace trace{.name = run.name,
                    .x = SecondsOf(run.deviation),
                    .y = Scaled(run.deviation, "deviation", kMmPerM)};
    if (trace.y.size() != trace.x.size()) continue;
    StyleController(trace);
    plot.traces.push_back(std::move(trace));
  }
  if (!plot.traces.empty()) report.AddPlot(plot);
}

void AddPaths(Report& report, const std::vector<Run>& runs) {
  Plot plot{
      .title = "Path of the tip",
      .caption = "In the robot's frame. Drag to turn, scroll to zoom, click a name to hide it.",
      .x_label = kX,
      .y_label = kY,
      .z_label = kZ};
  for (const auto& run : runs) {
    auto trace = PathTrace(run.deviation, "p_RE", run.name.empty() ? "tip" : run.name);
    if (trace.x.empty()) continue;
    StyleController(trace);
    plot.traces.push_back(std::move(trace));
  }
  if (!runs.empty()) {
    auto desired = PathTrace(runs.front().deviation, "p_desired", "desired");
    desired.color = "#1d2733";
    if (!desired.x.empty()) plot.traces.push_back(std::move(desired));
  }
  if (!plot.traces.empty()) report.AddPlot(plot);
}

/// The last frame that each run's camera took; of a single run, frames from all of it.
void AddFrames(Report& report, const std::vector<Run>& runs) {
  std::vector<std::pair<std::string, std::string>> pictures;
  for (const auto& run : runs) {
    auto files = PicturesIn(run.folder / "overlay", kPictures);
    if (files.empty()) files = PicturesIn(run.folder / "cam0" / "data", kPictures);
    if (files.empty()) continue;
    if (run.name.empty()) return AddPictureFiles(report, "Through the laparoscope", files);
    pictures.emplace_back(ReadBytes(files.back()),
                          run.name + ", " + files.back().filename().string());
  }
  if (pictures.empty()) return;
  report.AddHeading("Through the laparoscope, at the end of each run");
  report.AddPictures(pictures);
}

/// A file of numbers as it is, for tables that are short enough to be read.
void AddShortTable(Report& report, const fs::path& file, const std::string& title) {
  constexpr std::size_t kRows = 60;
  if (!fs::exists(file)) return;
  const auto table = ReadResultTable(file);
  const std::size_t shown = std::min(kRows, table.Rows());
  Table out{.title = title, .header = table.names};
  if (shown < table.Rows()) {
    out.caption = "The first " + std::to_string(shown) + " of " + std::to_string(table.Rows()) +
                  " rows; all are in " + file.filename().string() + ".";
  }
  for (std::size_t r = 0; r < shown; ++r) {
    std::vector<std::string> row;
    for (const auto& column : table.texts) row.push_back(column[r]);
    out.rows.push_back(std::move(row));
  }
  report.AddTable(out);
}

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

void WriteSimulateReport(const fs::path& folder) {
  Report report = BeginPage(folder, "Simulated closed loop");
  const auto runs = ReadRuns(folder);
  if (!runs.empty()) report.AddHeading("Which controller keeps the tip where it is wanted");
  AddDeviations(report, runs);
  AddPaths(report, runs);
  AddFrames(report, runs);
  report.Write(folder / "report.html");
}

void WriteEstimateReport(const fs::path& folder) {
  Report report = BeginPage(folder, "Instrument fitted to the sensors");
  const auto data = folder / "state0" / "data.csv";
  if (fs::exists(data)) {
    const auto table = ReadResultTable(data);
    report.AddHeading("State over time");
    const auto path = PathTrace(table, "p_RE", "tip");
    if (!path.x.empty()) {
      report.AddPlot({.title = "Path of the tip",
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
