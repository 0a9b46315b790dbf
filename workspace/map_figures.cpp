#include "workspace/map_figures.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace flextip {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr double kDegrees = 180.0 / std::numbers::pi;
constexpr double kMm = 1000.0;

template <int N>
double ValueOf(const PointMeasures<N>& at, MapQuantity quantity) {
  if (!at.state || !at.step.IsUsable()) return kNone;
  switch (quantity) {
    case MapQuantity::kNorm:
      return at.step.norm;
    case MapQuantity::kPhiHat:
      return at.step.phi_hat_max_rad * kDegrees;
    case MapQuantity::kPhiMax:
      break;
  }
  return at.angle.IsUsable() ? at.angle.phi_max_rad * kDegrees : kNone;
}

report::FigureField Style(MapQuantity quantity) {
  if (quantity == MapQuantity::kNorm)
    return {.name = "||G||", .levels = {0.25, 0.5, 0.75, 1.0, 1.5, 2.0}, .low = 0.0, .high = 2.0};
  if (quantity == MapQuantity::kPhiHat)  // nothing between 90 and 180
    return {.name = "bound (deg)", .levels = {15, 30, 45, 60, 135}, .low = 0.0, .high = 180.0};
  return {.name = "largest angle (deg)",
          .levels = {15, 30, 45, 60, 90, 135},
          .low = 0.0,
          .high = 180.0};
}

/// "z (mm)", by the component of VectorN<N>.
template <int N>
std::string AxisLabel(int component) {
  const char* names = N == 2 ? "zy" : "xyz";
  return std::string(1, names[component]) + " (mm)";
}

template <int N>
report::Figure EmptyFigure(const Slice<N>& slice) {
  report::Figure figure;
  figure.x_label = AxisLabel<N>(slice.right);
  figure.y_label = AxisLabel<N>(slice.up);
  figure.equal_axes = true;
  return figure;
}

std::vector<double> InMm(const std::vector<double>& lines) {
  std::vector<double> mm;
  mm.reserve(lines.size());
  for (const double x : lines) mm.push_back(ToDigits(kMm * x, 8));
  return mm;
}

/// The direction's line and how long it is drawn, one being the longest; empty where there is none.
template <int N>
std::optional<VectorN<N>> Drawn(const PointMeasures<N>& at, MapDirection direction, bool scaled) {
  if (!at.state || !at.step.IsUsable() || !at.angle.IsUsable()) return std::nullopt;
  constexpr double kLongestNorm = 2.0;
  if (direction == MapDirection::kVSigma)
    return at.step.v_sigma * (scaled ? std::min(at.step.norm / kLongestNorm, 1.0) : 1.0);
  return at.angle.p_phi * (scaled ? at.angle.phi_max_rad / std::numbers::pi : 1.0);
}

}  // namespace

double ToDigits(double value, int digits) {
  if (value == 0.0 || !std::isfinite(value)) return value;
  const double scale = std::pow(10.0, digits - 1 - std::floor(std::log10(std::abs(value))));
  return std::round(value * scale) / scale;
}

template <int N>
std::vector<double> ValuesOf(const WorkspaceMap<N>& map, MapQuantity quantity) {
  std::vector<double> values;
  for (const auto& at : map.points) values.push_back(ToDigits(ValueOf(at, quantity), 4));
  return values;
}

template <int N>
report::Figure MapFigure(const WorkspaceMap<N>& map, MapQuantity quantity,
                         const std::vector<double>& values) {
  report::Figure figure = EmptyFigure(map.slice);
  report::FigureField field = Style(quantity);
  field.x = InMm(map.right_m);
  field.y = InMm(map.up_m);
  field.values = values;
  figure.fields.push_back(std::move(field));
  return figure;
}

template <int N>
report::Figure DirectionFigure(const WorkspaceMap<N>& map, MapDirection direction, bool scaled,
                               double every_m) {
  report::Figure figure = EmptyFigure(map.slice);
  const auto every = std::max<std::size_t>(1, std::size_t(std::round(every_m / map.spacing_m)));
  const double longest_mm = kMm * map.spacing_m * double(every) * (scaled ? 1.6 : 0.8);
  std::vector<double> x, y, u, v;
  for (std::size_t r = every / 2; r < map.up_m.size(); r += every) {
    for (std::size_t c = every / 2; c < map.right_m.size(); c += every) {
      const auto drawn = Drawn(map.At(r, c), direction, scaled);
      if (!drawn) continue;
      const Eigen::Vector2d line = longest_mm * map.slice.InPlane(*drawn);
      x.push_back(ToDigits(kMm * map.right_m[c], 8));
      y.push_back(ToDigits(kMm * map.up_m[r], 8));
      u.push_back(line.x());
      v.push_back(line.y());
    }
  }
  report::FigureTrace trace = report::Segments(x, y, u, v);
  for (double& value : trace.x) value = ToDigits(value);
  for (double& value : trace.y) value = ToDigits(value);
  figure.traces.push_back(std::move(trace));
  return figure;
}

report::FigureTrace TraceInMm(const std::vector<Eigen::Vector2d>& points_m,
                              report::FigureTrace style) {
  for (const auto& p : points_m) {
    style.x.push_back(ToDigits(kMm * p.x()));
    style.y.push_back(ToDigits(kMm * p.y()));
  }
  return style;
}

template <int N>
void MarkPorts(report::Figure& figure, const MapSetup<N>& setup, const Slice<N>& slice) {
  const report::FigureTrace port{.name = "port",
                                 .kind = report::FigureTrace::Kind::kPoints,
                                 .color = "#b00020",
                                 .symbol = "circle-open"};
  const report::FigureTrace believed{.name = "believed port",
                                     .kind = report::FigureTrace::Kind::kPoints,
                                     .color = "#b00020",
                                     .symbol = "x-thin"};
  figure.traces.push_back(TraceInMm({slice.InPlane(setup.truth.p_port)}, port));
  if (setup.error.port_m.norm() == 0.0) return;
  const VectorN<N> p_hat = setup.truth.p_port + setup.error.port_m;
  figure.traces.push_back(TraceInMm({slice.InPlane(p_hat)}, believed));
}

template std::vector<double> ValuesOf(const WorkspaceMap<2>&, MapQuantity);
template std::vector<double> ValuesOf(const WorkspaceMap<3>&, MapQuantity);
template report::Figure MapFigure(const WorkspaceMap<2>&, MapQuantity, const std::vector<double>&);
template report::Figure MapFigure(const WorkspaceMap<3>&, MapQuantity, const std::vector<double>&);
template report::Figure DirectionFigure(const WorkspaceMap<2>&, MapDirection, bool, double);
template report::Figure DirectionFigure(const WorkspaceMap<3>&, MapDirection, bool, double);
template void MarkPorts(report::Figure&, const MapSetup<2>&, const Slice<2>&);
template void MarkPorts(report::Figure&, const MapSetup<3>&, const Slice<3>&);

}  // namespace flextip
