// The page of flextip track, from frames.csv and vision0/data.csv, thinned: it is as long for an
// hour of frames as for a minute.
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "report/page_parts.h"
#include "report/pages.h"
#include "report/summary_parts.h"
#include "report/thinned_table.h"

namespace flextip::report {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kPictures = 12, kBuckets = 1500;
constexpr double kMmPerM = 1000.0;
constexpr const char* kPredicted = "#d55e00";

ThinnedColumn Plain(const std::string& name, double factor = 1.0) {
  return {{name}, [factor](const std::vector<double>& v) { return factor * v[0]; }};
}

ThinnedTable ReadFrames(const fs::path& file, const std::vector<ThinnedColumn>& columns) {
  return ReadThinned(file, columns, "status", {"ok", "predicted", "lost"}, kBuckets);
}

/// Adds overlay.mp4, where there is one. It stays a file: an hour of video is no part of a page.
void AddVideo(Report& report, const fs::path& folder) {
  if (!fs::exists(folder / "overlay.mp4")) return;
  report.AddHeading("The video");
  report.AddHtml(
      "<figure class=\"video\"><video controls muted preload=\"metadata\" src=\"overlay.mp4\">"
      "<a href=\"overlay.mp4\">overlay.mp4</a></video>\n<figcaption>overlay.mp4, a file beside "
      "this page: every frame with the tags and the tip that were found.</figcaption></figure>\n");
}

/// Where the tip was not seen.
std::vector<FigureBand> StatusBands(const ThinnedTable& table) {
  std::vector<FigureBand> bands;
  std::string before;
  for (std::size_t i = 0; i < table.buckets.size(); ++i) {
    const ThinnedBucket& bucket = table.buckets[i];
    const double end_s = i + 1 < table.buckets.size() ? table.buckets[i + 1].t_s : table.end_s;
    const bool hidden = bucket.worst_text == "predicted" || bucket.worst_text == "lost";
    if (hidden && bucket.worst_text == before) {
      bands.back().to = end_s;
    } else if (hidden) {
      bands.push_back({bucket.t_s, end_s, bucket.worst_text == "lost" ? "#c0392b" : kPredicted});
    }
    before = bucket.worst_text;
  }
  return bands;
}

/// What the bands say, where there are any.
std::string BandsSay(const ThinnedTable& table) {
  return StatusBands(table).empty() ? "" : " Orange: predicted; red: lost.";
}

bool AddTrace(const ThinnedTable& table, std::size_t column, FigureTrace trace, Figure& plot) {
  table.Trace(column, trace.x, trace.y);
  bool any = false;
  for (const double y : trace.y) any = any || std::isfinite(y);
  if (any) plot.traces.push_back(std::move(trace));
  return any;
}

/// The path of the tip, and one trace for each status it had.
void AddPath(Report& report, const ThinnedTable& table) {
  Figure plot{.title = "Path of the tip as seen",
              .x_label = "x (mm)",
              .y_label = "y (mm)",
              .z_label = "z (mm)"};
  FigureTrace path{.name = "path", .color = "#0072b2"};
  FigureTrace ok{.name = "ok", .kind = FigureTrace::Kind::kPoints, .color = "#009e73"};
  FigureTrace predicted{
      .name = "predicted", .kind = FigureTrace::Kind::kPoints, .color = kPredicted};
  const auto add = [](const ThinnedBucket& bucket, FigureTrace& trace) {
    trace.x.push_back(bucket.columns[0].first);
    trace.y.push_back(bucket.columns[1].first);
    trace.z.push_back(bucket.columns[2].first);
  };
  for (const ThinnedBucket& bucket : table.buckets) {
    add(bucket, path);
    if (bucket.first_text == "ok") add(bucket, ok);
    if (bucket.first_text == "predicted") add(bucket, predicted);
  }
  for (FigureTrace* trace : {&path, &ok, &predicted}) {
    if (!trace->x.empty()) plot.traces.push_back(std::move(*trace));
  }
  report.AddFigure(plot);
}

/// The values less the first one that is a number.
void FromFirst(std::vector<double>& values) {
  double start = std::nan("");
  for (double& v : values) {
    if (std::isnan(start)) start = v;
    v -= start;
  }
}

void AddTip(Report& report, const fs::path& file) {
  if (!fs::exists(file)) return;
  const auto sd_mm = [](const std::vector<double>& v) {
    return kMmPerM * std::sqrt(v[0] + v[1] + v[2]);
  };
  const ThinnedTable table = ReadFrames(file, {Plain("p_RE_x", kMmPerM),
                                               Plain("p_RE_y", kMmPerM),
                                               Plain("p_RE_z", kMmPerM),
                                               {{"cov_xx", "cov_yy", "cov_zz"}, sd_mm}});
  const bool seen = std::any_of(table.buckets.begin(), table.buckets.end(), [](const auto& bucket) {
    return std::isfinite(bucket.columns[0].least);
  });
  if (!seen) return;
  report.AddHeading("The tip");
  AddPath(report, table);
  Figure movement{.title = "Movement of the tip",
                  .caption = std::string("Along the robot's axes, from where it was seen first.") +
                             BandsSay(table),
                  .x_label = "time (s)",
                  .y_label = "movement (mm)",
                  .bands = StatusBands(table)};
  constexpr const char* kAxes[] = {"x", "y", "z"};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (AddTrace(table, axis, {.name = kAxes[axis]}, movement)) FromFirst(movement.traces.back().y);
  }
  report.AddFigure(movement);
  Figure sure{.title = "How sure the position is",
              .caption = std::string("Standard deviation of the position, all three axes "
                                     "together, on a logarithmic scale.") +
                         BandsSay(table),
              .x_label = "time (s)",
              .y_label = "standard deviation (mm)",
              .log_y = true,
              .bands = StatusBands(table)};
  if (AddTrace(table, 3, {.name = "standard deviation"}, sure)) report.AddFigure(sure);
}

void AddError(Report& report, const ThinnedTable& table) {
  Figure plot{.title = "Error of the tip",
              .caption = std::string("How far the tip was from the truth, and what its covariance "
                                     "says; on a logarithmic scale.") +
                         BandsSay(table),
              .x_label = "time (s)",
              .y_label = "error (mm)",
              .log_y = true,
              .bands = StatusBands(table)};
  if (!AddTrace(table, 0, {.name = "error"}, plot)) return;
  AddTrace(table, 1, {.name = "standard deviation", .color = "#555f6b", .dashed = true}, plot);
  report.AddFigure(plot);
}

void AddFrames(Report& report, const fs::path& file) {
  if (!fs::exists(file)) return;
  const ThinnedTable table =
      ReadFrames(file, {Plain("error", kMmPerM), Plain("sd_position", kMmPerM), Plain("noise_grey"),
                        Plain("rms_px"), Plain("tags_used")});
  if (table.buckets.empty()) return;
  report.AddHeading("Frame by frame");
  AddError(report, table);
  const auto add = [&](std::size_t column, const char* title, const char* caption,
                       const char* unit) {
    Figure plot{.title = title,
                .caption = std::string(caption) + BandsSay(table),
                .x_label = "time (s)",
                .y_label = unit,
                .bands = StatusBands(table)};
    if (AddTrace(table, column, {.name = title}, plot)) report.AddFigure(plot);
  };
  add(2, "Noise", "What the fit of the tags' pixels leaves.", "noise (grey levels)");
  add(3, "Corners' distance", "Of frames that were found by the tags' corners alone.",
      "distance (px)");
  add(4, "Tags", "Those that the fit used, in all cameras.", "tags");
}

}  // namespace

void WriteTrackReport(const fs::path& folder) {
  Report report = BeginPage(folder, "Tip tracked in frames");
  AddPictureFiles(report, "What was found in the frames",
                  PicturesIn(folder / "overlay", kPictures));
  AddVideo(report, folder);
  AddTip(report, folder / "vision0" / "data.csv");
  AddFrames(report, folder / "frames.csv");
  report.Write(folder / "report.html");
}

}  // namespace flextip::report
