#include "apps/calibrate/camera/board_shape_output.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "calibration/camera/board_shape.h"

namespace flextip {
namespace {

// The distinct values of one coordinate, ascending: the lines of the board's grid.
std::vector<double> Lines(const std::vector<Eigen::Vector3d>& x_B, int axis, double nearest_m) {
  std::vector<double> all, lines;
  for (const Eigen::Vector3d& x : x_B) all.push_back(x[axis]);
  std::sort(all.begin(), all.end());
  for (const double v : all) {
    if (lines.empty() || v - lines.back() > nearest_m) lines.push_back(v);
  }
  return lines;
}

std::size_t Nearest(const std::vector<double>& lines, double value) {
  const auto nearer = [&](double a, double b) { return std::abs(a - value) < std::abs(b - value); };
  return static_cast<std::size_t>(std::min_element(lines.begin(), lines.end(), nearer) -
                                  lines.begin());
}

// A round number by which the longest line is about as long as the corners are apart.
double Exaggeration(const BoardShape& shape, double step_m) {
  double longest_m = 1e-9;
  for (const auto& [id, offset] : shape.offset_B) {
    longest_m = std::max(longest_m, offset.head<2>().norm());
  }
  const double most = 0.9 * step_m / longest_m;
  const double ten = std::pow(10.0, std::floor(std::log10(most)));
  return most >= 5 * ten ? 5 * ten : most >= 2 * ten ? 2 * ten : ten;
}

std::vector<double> InMm(std::vector<double> values) {
  for (double& v : values) v *= 1e3;
  return values;
}

}  // namespace

nlohmann::json BoardShapeJson(const BoardShape& shape, const std::string& reason) {
  nlohmann::json json = {{"estimated", shape.sd_m > 0}, {"reason", reason}};
  if (!(shape.sd_m > 0)) return json;
  const auto [rms_m, longest_m] = SizeOf(shape);
  json.update({{"rms_m", rms_m}, {"longest_m", longest_m}, {"prior_sd_m", shape.sd_m}});
  for (const auto& [id, offset] : shape.offset_B) {
    json["offsets_m"].push_back({id, offset.x(), offset.y(), offset.z()});
  }
  return json;
}

void AddBoardFigure(const std::vector<Eigen::Vector3d>& x_B, const BoardWarp& warp,
                    const BoardShape& shape, std::vector<report::Figure>& figures) {
  if (!(shape.sd_m > 0) || x_B.size() < 2) return;
  const double step_m = (x_B[1] - x_B[0]).norm(), exaggeration = Exaggeration(shape, step_m);
  const auto columns = Lines(x_B, 0, 0.1 * step_m), rows = Lines(x_B, 1, 0.1 * step_m);
  report::FigureField behind{.name = "behind the plane (mm)", .x = InMm(columns), .y = InMm(rows)};
  behind.values.assign(columns.size() * rows.size(), std::numeric_limits<double>::quiet_NaN());
  report::FigureTrace moved{.name = fmt::format("corners, {:.0f} times as far", exaggeration)};
  for (const auto& [id, offset] : shape.offset_B) {
    const Eigen::Vector3d& x = x_B[static_cast<std::size_t>(id)];
    behind.values[Nearest(rows, x.y()) * columns.size() + Nearest(columns, x.x())] =
        1e3 * (warp.Bent(x).z() + offset.z());
    const Eigen::Vector3d to = x + exaggeration * offset;
    const double gap = std::numeric_limits<double>::quiet_NaN();
    moved.x.insert(moved.x.end(), {1e3 * x.x(), 1e3 * to.x(), gap});
    moved.y.insert(moved.y.end(), {1e3 * x.y(), 1e3 * to.y(), gap});
  }
  moved.color = "#1d2733";
  report::Figure figure{
      .name = "board-shape",
      .title = "The board as it is",
      .caption =
          "From where a corner is described to where it is, exaggerated; colours: "
          "how far behind the described plane it is.",
      .x_label = "along the rows (mm)",
      .y_label = "along the columns (mm)",
      .y_down = true,
      .equal_axes = true};
  figure.fields = {std::move(behind)};
  figure.traces = {std::move(moved)};
  figures.push_back(std::move(figure));
}

}  // namespace flextip
