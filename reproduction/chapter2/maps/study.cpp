// ||G|| and the angles: the statements of 2.3.1 about Fig. 2.4, and gains.
#include "reproduction/chapter2/maps/study.h"

#include <fmt/format.h>

#include "reproduction/chapter2/maps/pictures.h"
#include "reproduction/chapter2/maps/statistics.h"

namespace flextip::reproduction {
namespace {

using Point = PointMeasures<2>;
constexpr double kMm = 1000.0;

double PhiMaxDeg(const Point& at) { return kDegreesPerRad * at.angle.phi_max_rad; }
double PhiHatDeg(const Point& at) { return kDegreesPerRad * at.step.phi_hat_max_rad; }
double WristFromPortMm(const Point& at) {
  return kMm * (at.state->p_wrist - PlanarInstrument{}.p_port).norm();
}
bool ErrorsGrow(const Point& at) { return at.step.norm > 1.0; }

/// Along one ray from the port outward: where ||G|| passes 1 and where |phi_max| passes 45 degrees.
struct Crossings {
  double norm_m = 0.0, angle_m = 0.0;  ///< from the port
  double phi_at_norm_deg = 0.0;
};

/// The outer ones; empty where the ray leaves the workspace before both.
std::optional<Crossings> OuterCrossings(const MapSetup<2>& setup, double bearing_rad) {
  constexpr double kFrom_m = 0.17, kStep_m = 0.0002;
  const Eigen::Vector2d ray(std::cos(bearing_rad), std::sin(bearing_rad));
  TrueShaft<2> shaft(setup.truth, setup.force);
  std::optional<double> norm_m, angle_m;
  double phi_deg = 0.0;
  for (double r = kFrom_m; r < setup.truth.shaft_m && !(norm_m && angle_m); r += kStep_m) {
    const Point at = MeasureAt(setup, shaft, Eigen::Vector2d(setup.truth.p_port + r * ray));
    if (!at.A) continue;
    if (!norm_m && at.step.norm > 1.0) norm_m = r, phi_deg = PhiMaxDeg(at);
    if (!angle_m && PhiMaxDeg(at) > 45.0) angle_m = r;
  }
  if (!norm_m || !angle_m) return std::nullopt;
  return Crossings{*norm_m, *angle_m, phi_deg};
}

std::vector<TableRow> StudyContours() {
  const MapSetup<2> setup = ThesisSetup(kThesisError);
  std::vector<double> apart_mm, phi_deg;
  for (double bearing_deg = -90.0; bearing_deg <= 30.0; bearing_deg += 1.0) {
    const auto at = OuterCrossings(setup, bearing_deg / kDegreesPerRad);
    if (!at) continue;
    apart_mm.push_back(kMm * std::abs(at->norm_m - at->angle_m));
    phi_deg.push_back(at->phi_at_norm_deg);
  }
  return {{"2.3.1 135 degrees of the bound to 45 degrees of phi_max, mean distance",
           {},
           Mean(apart_mm),
           "mm",
           "Along rays from the port, at the right and the bottom; both lines run along the edge."},
          {"2.3.1 135 degrees of the bound to 45 degrees of phi_max, largest distance",
           {},
           QuantileOrNan(apart_mm, 1.0),
           "mm",
           ""},
          {"2.3.1 |phi_max| on the bound's line of 135 degrees, mean", 45.0, Mean(phi_deg), "deg",
           "The bound jumps from 90 to 180 where ||G|| = 1, so its 135 degrees are that line."},
          {"2.3.1 |phi_max| on the bound's line of 135 degrees, smallest", 45.0,
           QuantileOrNan(phi_deg, 0.0), "deg", "At the upper right."},
          {"2.3.1 |phi_max| on the bound's line of 135 degrees, largest", 45.0,
           QuantileOrNan(phi_deg, 1.0), "deg", "At the bottom left."}};
}

/// The believed Jacobian if the shaft's direction came from the tip that is known instead of from
/// the wrist: the other way to read 2.3.2.
double ShareWithTheTipsDirection(const WorkspaceMap<2>& map) {
  PlanarInstrument belief;
  belief.p_port += kThesisError;
  return ShareOf(map, [&](const Point& at) {
    const auto p_wrist = belief.WristOnLine(at.p_tip);
    if (!p_wrist) return true;
    const Eigen::Matrix2d J_hat =
        belief.TipByWrist(*p_wrist) * belief.arm.Jacobian(at.state->theta);
    return FindStepError(at.state->J, J_hat).norm > 1.0;
  });
}

std::vector<TableRow> StudyStarts() {
  const MapSetup<2> setup = ThesisSetup(kThesisError);
  TrueShaft<2> shaft(setup.truth, setup.force);
  std::vector<TableRow> rows;
  const std::pair<const char*, Eigen::Vector2d> starts[] = {
      {"L", kStartL}, {"M", kStartM}, {"N", kStartN}};
  for (const auto& [name, p_tip] : starts) {
    const Point at = MeasureAt(setup, shaft, p_tip);
    rows.push_back({std::string("Fig. 2.4 ||G|| at ") + name,
                    {},
                    at.step.norm,
                    "",
                    "2.3.2 puts L, M and N in areas of increasing error."});
    rows.push_back({std::string("Fig. 2.4 |phi_max| at ") + name, {}, PhiMaxDeg(at), "deg", ""});
  }
  return rows;
}

}  // namespace

std::vector<TableRow> StudyMeasures(const WorkspaceMap<2>& map) {
  const double cm2 = 1e4 * map.spacing_m * map.spacing_m;
  const auto far_from_port = [](const Point& at) { return WristFromPortMm(at) < 100.0; };
  const auto tip_near_port = [](const Point& at) { return WristFromPortMm(at) > 260.0; };
  const auto middle = [](const Point& at) {
    return WristFromPortMm(at) >= 100.0 && WristFromPortMm(at) <= 260.0;
  };
  const auto excess = [](const Point& at) { return PhiHatDeg(at) - PhiMaxDeg(at); };
  const auto all = [](const Point&) { return true; };
  std::vector<TableRow> rows{
      {"2.3.1 area of the tip's workspace", {}, cm2 * double(map.Reached()), "cm2", ""},
      {"2.3.1 part of it with ||G|| > 1",
       {},
       100.0 * ShareOf(map, ErrorsGrow),
       "%",
       "The thesis: a large portion. It is a rim at the right and the bottom and a spot at the "
       "port."},
      {"2.3.1 part with ||G|| > 1 where the wrist is within 100 mm of the port",
       {},
       100.0 * ShareOf(map, far_from_port, ErrorsGrow),
       "%",
       "The tip is then at the right and bottom edge."},
      {"2.3.1 part with ||G|| > 1 where the tip is within 60 mm of the port",
       {},
       100.0 * ShareOf(map, tip_near_port, ErrorsGrow),
       "%",
       ""},
      {"2.3.1 part with ||G|| > 1 in between",
       {},
       100.0 * ShareOf(map, middle, ErrorsGrow),
       "%",
       ""},
      {"2.3.1 part with ||G|| > 1 if the believed shaft pointed to the known tip",
       {},
       100.0 * ShareWithTheTipsDirection(map),
       "%",
       "The other reading of a known tip; it leaves no large portion, so it is not the thesis's."},
      {"2.3.1 part with ||G|| <= 0.5",
       {},
       100.0 * ShareOf(map, [](const Point& at) { return at.step.norm <= 0.5; }),
       "%",
       "The thesis: in the middle."},
      {"2.3.1 part of the middle with ||G|| <= 0.5",
       {},
       100.0 * ShareOf(map, middle, [](const Point& at) { return at.step.norm <= 0.5; }),
       "%",
       "Middle: the wrist 100 to 260 mm from the port."},
      {"2.3.1 least bound minus phi_max",
       {},
       QuantileOrNan(Collect(map, all, excess), 0.0),
       "deg",
       "Conservative everywhere if not negative."},
      {"2.4 bound minus phi_max in the middle, median",
       {},
       QuantileOrNan(Collect(map, middle, excess), 0.5),
       "deg",
       "The thesis: closely estimating there."},
      {"2.4 bound minus phi_max, wrist within 100 mm of the port, median",
       {},
       QuantileOrNan(Collect(map, far_from_port, excess), 0.5),
       "deg",
       "The thesis: quite large."},
      {"2.3.1 part with |phi_max| <= 90 deg",
       {},
       100.0 * ShareOf(map, [](const Point& at) { return PhiMaxDeg(at) <= 90.0; }),
       "%",
       "The thesis: most of the workspace."},
      {"2.3.1 |phi_max|, tip or wrist within 60 mm of the port, median",
       {},
       QuantileOrNan(Collect(
                         map,
                         [](const Point& at) {
                           return WristFromPortMm(at) < 60.0 || WristFromPortMm(at) > 260.0;
                         },
                         PhiMaxDeg),
                     0.5),
       "deg",
       "The thesis: larger values near the port."},
      {"2.3.1 |phi_max|, both further than 60 mm from it, median",
       {},
       QuantileOrNan(Collect(
                         map,
                         [](const Point& at) {
                           return WristFromPortMm(at) >= 60.0 && WristFromPortMm(at) <= 260.0;
                         },
                         PhiMaxDeg),
                     0.5),
       "deg",
       ""}};
  for (const auto& more : {StudyContours(), StudyStarts()})
    rows.insert(rows.end(), more.begin(), more.end());
  return rows;
}

std::vector<TableRow> StudyGains(double spacing_m) {
  std::vector<TableRow> rows;
  const auto all = [](const Point&) { return true; };
  for (const double gain : {0.01, 0.1, 0.5, 1.0, 1.5, 2.0}) {
    MapSetup<2> setup = ThesisSetup(kThesisError);
    setup.gain = gain;
    const auto map = ComputeMap(setup, {}, spacing_m);
    const auto norms = Collect(map, all, [](const Point& at) { return at.step.norm; });
    const std::string at_gain = fmt::format(" at k = {}", gain);
    rows.push_back({"2.3.1 ||G||" + at_gain + ", median",
                    {},
                    QuantileOrNan(norms, 0.5),
                    "",
                    gain == 0.01  ? "Constricts to 1 as the thesis says, because G goes to I."
                    : gain == 2.0 ? "Not proportional to k: G = I - k J J_hat^-1."
                                  : ""});
    rows.push_back({"2.3.1 ||G||" + at_gain + ", 95 % of the workspace below",
                    {},
                    QuantileOrNan(norms, 0.95),
                    "",
                    ""});
    rows.push_back(
        {"2.3.1 part with ||G|| > 1" + at_gain,
         {},
         100.0 * ShareOf(map, ErrorsGrow),
         "%",
         gain == 0.01 ? "What is left is where |phi_max| > 90 deg: no gain helps there." : ""});
  }
  return rows;
}

}  // namespace flextip::reproduction
