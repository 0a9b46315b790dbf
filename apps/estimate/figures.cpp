#include "apps/estimate/figures.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>

#include "pipeline/estimated_shape.h"
#include "pipeline/sensor_readings.h"

namespace flextip {
namespace {

using Eigen::Vector3d;
using report::Figure;
using report::FigureTrace;

constexpr double kMmPerM = 1000.0;
constexpr int kPlaces = 61;
constexpr std::size_t kTimes = 1500;  // of a curve over time
constexpr double kDeviations = 2.0;
constexpr const char* kInk = "#1d2733";
constexpr const char* kQuiet = "#828c96";
constexpr const char* kShaft = "#0072b2";
constexpr const char* kPort = "#009e73";
constexpr const char* kTip = "#d55e00";
constexpr const char* kEm = "#cc79a7";
constexpr const char* kAcross = "#0072b2";
constexpr const char* kAlong = "#d55e00";

/// A plane through the wrist: along the straight shaft, and the way in which it bends.
struct BendingPlane {
  Vector3d origin = Vector3d::Zero(), along = Vector3d::UnitX(), across = Vector3d::UnitY();

  double Along_mm(const Vector3d& p) const { return kMmPerM * along.dot(p - origin); }
  double Across_mm(const Vector3d& p) const { return kMmPerM * across.dot(p - origin); }
  double AcrossSd_mm(const Eigen::Matrix3d& covariance_m2) const {
    return kMmPerM * std::sqrt(std::max(0.0, across.dot(covariance_m2 * across)));
  }
  FigureTrace Point(const Vector3d& p, const char* name, const char* color) const {
    return {.name = name,
            .kind = FigureTrace::Kind::kPoints,
            .x = {Along_mm(p)},
            .y = {Across_mm(p)},
            .color = color};
  }
};

struct BentMost {
  std::size_t sample = 0;
  Measurements measured;
  Vector3d bend = Vector3d::Zero();  ///< the tip less the straight shaft's tip
};

std::optional<BentMost> FindBentMost(const Recording& recording,
                                     const Series<ShaftEstimate>& estimates) {
  std::optional<BentMost> most;
  for (std::size_t i = 0; i < estimates.size(); ++i) {
    const ShaftEstimate& e = estimates[i].value;
    if (e.status != EstimateStatus::kOk) continue;
    const auto measured = MeasurementsAt(recording, estimates[i].t_ns);
    if (!measured) continue;
    const Vector3d along = (e.model.p_RP - measured->p_RW).normalized();
    const Vector3d bend = e.p_RE - measured->p_RW - e.model.instrument.length_m * along;
    if (!most || bend.norm() > most->bend.norm()) most = BentMost{i, *measured, bend};
  }
  return most;
}

BendingPlane PlaneOf(const ShaftEstimate& e, const BentMost& most) {
  BendingPlane plane{.origin = most.measured.p_RW};
  plane.along = (e.model.p_RP - plane.origin).normalized();
  const Vector3d across = most.bend - plane.along * plane.along.dot(most.bend);
  plane.across =
      across.norm() > 1e-9 ? Vector3d(across.normalized()) : plane.along.unitOrthogonal();
  return plane;
}

void AddSensors(const BendingPlane& plane, const Measurements& measured, Figure& figure) {
  if (measured.tip) {
    auto tip = plane.Point(measured.tip->p_RE, "tip as seen", kTip);
    tip.y_error = {kDeviations * plane.AcrossSd_mm(measured.tip->covariance_m2)};
    figure.traces.push_back(tip);
  }
  if (measured.em) {
    auto em = plane.Point(measured.em->T_RS.p, "EM sensor", kEm);
    em.y_error = {kDeviations * kMmPerM * measured.em->position_noise_m};
    figure.traces.push_back(em);
  }
}

std::optional<Figure> BentShaft(const Recording& recording,
                                const Series<ShaftEstimate>& estimates) {
  const auto most = FindBentMost(recording, estimates);
  if (!most) return {};
  const ShaftEstimate& e = estimates[most->sample].value;
  const auto shape = EstimatedShape(e, most->measured.p_RW, kPlaces);
  if (shape.empty()) return {};
  const BendingPlane plane = PlaneOf(e, *most);
  FigureTrace shaft{.name = "shaft", .color = kShaft};
  FigureTrace low{.name = "two standard deviations", .color = kShaft, .dashed = true};
  FigureTrace high{.color = kShaft, .dashed = true};
  for (const ShapePoint& place : shape) {
    const double x = plane.Along_mm(place.p_R), y = plane.Across_mm(place.p_R);
    const double sd = kDeviations * plane.AcrossSd_mm(place.covariance_m2);
    for (FigureTrace* trace : {&shaft, &low, &high}) trace->x.push_back(x);
    shaft.y.push_back(y);
    low.y.push_back(y - sd);
    high.y.push_back(y + sd);
  }
  const FigureTrace straight{.name = "straight shaft",
                             .x = {0.0, kMmPerM * e.model.instrument.length_m},
                             .y = {0.0, 0.0},
                             .color = kQuiet,
                             .dashed = true};
  const double t_s =
      1e-9 * static_cast<double>(estimates[most->sample].t_ns - estimates.front().t_ns);
  Figure figure{
      .name = "bent-shaft",
      .title = "The shaft where it bends most",
      .caption = fmt::format("At {:.2f} s, in the plane in which it bends: the tip is {:.2f} mm "
                             "from where a straight shaft has it, known to {:.2g} mm (one standard "
                             "deviation). The scales differ.",
                             t_s, kMmPerM * most->bend.norm(),
                             plane.AcrossSd_mm(shape.back().covariance_m2)),
      .x_label = "along the straight shaft (mm)",
      .y_label = "across (mm)"};
  figure.traces = {straight,
                   shaft,
                   low,
                   high,
                   plane.Point(plane.origin, "wrist", kInk),
                   plane.Point(e.model.p_RP, "port", kPort)};
  AddSensors(plane, most->measured, figure);
  return figure;
}

/// A curve with two standard deviations to both sides.
struct Banded {
  FigureTrace middle, low, high;

  Banded(const char* name, const char* color) {
    middle = {.name = name, .color = color};
    low = high = {.color = color, .dashed = true};
  }
  void Add(double t_s, double value, double sd) {
    for (FigureTrace* trace : {&middle, &low, &high}) trace->x.push_back(t_s);
    middle.y.push_back(value);
    low.y.push_back(value - kDeviations * sd);
    high.y.push_back(value + kDeviations * sd);
  }
};

std::optional<Figure> Forces(const Series<ShaftEstimate>& estimates) {
  Banded across("across the shaft", kAcross), along("along the shaft, toward the tip", kAlong);
  const std::size_t stride = 1 + estimates.size() / kTimes;
  for (std::size_t i = 0; i < estimates.size(); i += stride) {
    const ShaftEstimate& e = estimates[i].value;
    if (e.status != EstimateStatus::kOk) continue;
    const double t_s = 1e-9 * static_cast<double>(estimates[i].t_ns - estimates.front().t_ns);
    const Eigen::Matrix3d covariance = e.covariance.bottomRightCorner<3, 3>();
    const auto sd = [&](const Vector3d& u) {
      return std::sqrt(std::max(0.0, u.dot(covariance * u)));
    };
    const Vector3d& f = e.model.f_tip_N;
    const double f_along = e.d_RE.dot(f);
    const Vector3d f_across = f - f_along * e.d_RE;
    const Vector3d u =
        f_across.norm() > 1e-9 ? Vector3d(f_across.normalized()) : e.d_RE.unitOrthogonal();
    across.Add(t_s, f_across.norm(), sd(u));
    along.Add(t_s, f_along, sd(e.d_RE));
  }
  if (across.middle.x.empty()) return {};
  Figure figure{.name = "force",
                .title = "Force on the tip",
                .caption =
                    "Dashed: two standard deviations. The force along the shaft hardly bends "
                    "it, so the sensors hardly see it: its band is wide.",
                .x_label = "time (s)",
                .y_label = "force (N)"};
  figure.traces = {across.middle, across.low, across.high, along.middle, along.low, along.high};
  return figure;
}

}  // namespace

std::vector<Figure> EstimateFigures(const Recording& recording,
                                    const Series<ShaftEstimate>& estimates) {
  std::vector<Figure> figures;
  if (estimates.empty()) return figures;
  if (auto shaft = BentShaft(recording, estimates)) figures.push_back(std::move(*shaft));
  if (auto forces = Forces(estimates)) figures.push_back(std::move(*forces));
  return figures;
}

}  // namespace flextip
