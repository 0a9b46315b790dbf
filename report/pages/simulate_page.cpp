// The page of flextip simulate: every controller's deviation and path.
#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "report/page_parts.h"
#include "report/pages.h"
#include "report/report.h"
#include "report/result_files.h"
#include "report/stops/stops.h"
#include "report/summary_parts.h"

namespace flextip::report {
namespace {

namespace fs = std::filesystem;

constexpr double kMmPerM = 1000.0;
constexpr std::size_t kPictures = 6;
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
void StyleController(FigureTrace& trace) {
  for (const auto& [model, color] : kModelColors) {
    if (trace.name.starts_with(model)) trace.color = color;
  }
  trace.dashed = trace.name.find("calculate") != std::string::npos;
}

void AddDeviations(Report& report, const std::vector<Run>& runs) {
  Figure plot{.title = "Deviation from the desired path",
              .caption =
                  "How far the true tip was from where it was wanted. Solid: the tip is "
                  "measured; dashed: it is calculated from the model.",
              .x_label = "time (s)",
              .y_label = "deviation (mm)"};
  for (const auto& run : runs) {
    FigureTrace trace{.name = run.name,
                      .x = SecondsOf(run.deviation),
                      .y = Scaled(run.deviation, "deviation", kMmPerM)};
    if (trace.y.size() != trace.x.size()) continue;
    StyleController(trace);
    plot.traces.push_back(std::move(trace));
  }
  if (!plot.traces.empty()) report.AddFigure(plot);
}

void AddPaths(Report& report, const std::vector<Run>& runs) {
  Figure plot{
      .title = "Path of the tip",
      .caption = "In the robot's frame. Drag to turn, scroll to zoom, click a name to hide it.",
      .x_label = "x (mm)",
      .y_label = "y (mm)",
      .z_label = "z (mm)"};
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
  if (!plot.traces.empty()) report.AddFigure(plot);
}

/// The last frame that each run's camera took; of a single run, frames from all of it.
void AddFrames(Report& report, const std::vector<Run>& runs) {
  std::vector<std::pair<std::string, std::string>> pictures;
  for (const auto& run : runs) {
    auto files = PicturesIn(run.folder / "overlay", kPictures);
    if (files.empty()) files = PicturesIn(run.folder / "cam0" / "data", kPictures);
    if (run.name.empty() && !files.empty())
      return AddPictureFiles(report, "Through the laparoscope", files);
    if (fs::exists(run.folder / "last_frame.jpg")) files = {run.folder / "last_frame.jpg"};
    if (files.empty()) continue;
    const std::string file = files.back().filename().string();
    pictures.emplace_back(ReadBytes(files.back()), run.name.empty() ? file : run.name);
  }
  if (pictures.empty()) return;
  report.AddHeading("Through the laparoscope, at the end of each run");
  report.AddPictures(pictures);
}

}  // namespace

void WriteSimulateReport(const fs::path& folder) {
  const auto runs = ReadRuns(folder);
  Report report = BeginPage(folder, "Simulated closed loop", [&](Report& page) {
    for (const auto& run : runs) AddStops(page, run.folder, run.name);
  });
  if (!runs.empty()) report.AddHeading("Which controller keeps the tip where it is wanted");
  AddDeviations(report, runs);
  AddPaths(report, runs);
  AddFrames(report, runs);
  report.Write(folder / "report.html");
}

}  // namespace flextip::report
