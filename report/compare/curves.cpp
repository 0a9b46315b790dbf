#include "report/compare/curves.h"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "report/result_files.h"
#include "report/thinned_table.h"

namespace flextip::report {
namespace {

namespace fs = std::filesystem;

constexpr double kMmPerM = 1000.0;
constexpr std::size_t kMostPoints = 1000;  // of a curve

struct Curve {
  const char* command;
  const char* file;
  const char* column;
  const char* title;
  const char* y_label;
  double factor;
};
constexpr std::array kCurves = {
    Curve{"simulate", "deviation.csv", "deviation", "Deviation from the desired path",
          "deviation (mm)", kMmPerM},
    Curve{"track", "vision0/data.csv", "p_RE_x", "The tip, x", "x (mm)", kMmPerM},
    Curve{"track", "vision0/data.csv", "p_RE_y", "The tip, y", "y (mm)", kMmPerM},
    Curve{"track", "vision0/data.csv", "p_RE_z", "The tip, z", "z (mm)", kMmPerM},
    Curve{"estimate", "state0/data.csv", "p_RE_x", "The tip, x", "x (mm)", kMmPerM},
    Curve{"estimate", "state0/data.csv", "p_RE_y", "The tip, y", "y (mm)", kMmPerM},
    Curve{"estimate", "state0/data.csv", "p_RE_z", "The tip, z", "z (mm)", kMmPerM},
    Curve{"estimate", "state0/data.csv", "f_tip_y", "The tip's force, y", "force (N)", 1.0},
    Curve{"estimate", "state0/data.csv", "f_tip_z", "The tip's force, z", "force (N)", 1.0},
};

void AddTrace(const fs::path& file, const std::string& name, const Curve& curve, Figure& figure) {
  if (!fs::exists(file)) return;
  const double factor = curve.factor;
  const ThinnedColumn column{{curve.column},
                             [factor](const std::vector<double>& v) { return factor * v[0]; }};
  FigureTrace trace{.name = name};
  ReadThinned(file, {column}, "", {}, kMostPoints).Trace(0, trace.x, trace.y);
  if (std::any_of(trace.y.begin(), trace.y.end(), [](double y) { return std::isfinite(y); }))
    figure.traces.push_back(std::move(trace));
}

std::string TipFile(const std::string& command) {
  if (command == "track") return "vision0/data.csv";
  return command == "estimate" ? "state0/data.csv" : "";
}

/// The tips (mm) by their times (ns).
std::map<TimeNs, Eigen::Vector3d> TipsOf(const fs::path& file) {
  std::map<TimeNs, Eigen::Vector3d> tips;
  if (!fs::exists(file)) return tips;
  const ResultTable table = ReadResultTable(file);
  const auto *x = table.Column("p_RE_x"), *y = table.Column("p_RE_y"), *z = table.Column("p_RE_z");
  if (x == nullptr || y == nullptr || z == nullptr) return tips;
  for (std::size_t i = 0; i < table.t_ns.size(); ++i) {
    const Eigen::Vector3d p_mm = kMmPerM * Eigen::Vector3d((*x)[i], (*y)[i], (*z)[i]);
    if (p_mm.allFinite()) tips[table.t_ns[i]] = p_mm;
  }
  return tips;
}

/// Where two curves lie on one another: how far each run's tip is from the first run's at the same
/// time. Of neighbouring times the largest.
std::optional<Figure> DifferenceOf(const std::string& command, const std::vector<fs::path>& folders,
                                   const std::vector<std::string>& names) {
  const std::string file = TipFile(command);
  if (file.empty()) return {};
  const auto first = TipsOf(folders[0] / file);
  Figure figure{.title = "The tip: distance from that of " + names[0],
                .caption = "At times that both runs have.",
                .x_label = "time (s)",
                .y_label = "distance (mm)"};
  for (std::size_t run = 1; run < folders.size(); ++run) {
    FigureTrace trace{.name = names[run]};
    std::vector<std::pair<double, double>> points;
    for (const auto& [t_ns, p_mm] : TipsOf(folders[run] / file)) {
      const auto at = first.find(t_ns);
      if (at == first.end()) continue;
      points.emplace_back(1e-9 * static_cast<double>(t_ns - first.begin()->first),
                          (p_mm - at->second).norm());
    }
    const std::size_t together = 1 + points.size() / kMostPoints;
    for (std::size_t i = 0; i < points.size(); i += together) {
      std::pair<double, double> most = points[i];
      for (std::size_t k = i; k < std::min(points.size(), i + together); ++k) {
        if (points[k].second > most.second) most = points[k];
      }
      trace.x.push_back(most.first);
      trace.y.push_back(most.second);
    }
    if (trace.x.size() > 1) figure.traces.push_back(std::move(trace));
  }
  if (figure.traces.empty()) return {};
  return figure;
}

}  // namespace

std::vector<Figure> CurvesOf(const std::string& command, const std::vector<fs::path>& folders,
                             const std::vector<std::string>& names) {
  std::vector<Figure> figures;
  if (auto difference = DifferenceOf(command, folders, names))
    figures.push_back(std::move(*difference));
  for (const Curve& curve : kCurves) {
    if (command != curve.command) continue;
    Figure figure{.title = curve.title, .x_label = "time (s)", .y_label = curve.y_label};
    for (std::size_t i = 0; i < folders.size(); ++i) {
      AddTrace(folders[i] / curve.file, names[i], curve, figure);
      for (const auto& part : FoldersWith(folders[i], curve.file)) {  // of several controllers
        AddTrace(part / curve.file, names[i] + " " + part.filename().string(), curve, figure);
      }
    }
    if (!figure.traces.empty()) figures.push_back(std::move(figure));
  }
  return figures;
}

}  // namespace flextip::report
