#include "report/compare/curves.h"

#include <algorithm>
#include <array>
#include <cmath>

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

}  // namespace

std::vector<Figure> CurvesOf(const std::string& command, const std::vector<fs::path>& folders,
                             const std::vector<std::string>& names) {
  std::vector<Figure> figures;
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
