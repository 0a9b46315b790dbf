// Line charts as SVG, written here.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace flextip::bench {

struct PlotLine {
  std::string name;  ///< lines of one name have one colour in all plots of a picture
  std::vector<std::pair<double, double>> points;
};
struct Panel {
  std::string title, x_label, y_label;
  bool log_x = false, log_y = false;  ///< points that are not positive are left out
  std::vector<PlotLine> lines;
};

/// Panels side by side, `columns` in a row; names stand at the ends of their lines. Where x is
/// logarithmic it must be positive.
std::string PlotsSvg(const std::vector<Panel>& plots, const std::string& title, int columns);

}  // namespace flextip::bench
