// Where the worst directions point (2.3.1 on Fig. 2.5), and port errors in four directions
// (Fig. 2.6).
#include "reproduction/chapter2/maps/pictures.h"
#include "reproduction/chapter2/maps/statistics.h"
#include "reproduction/chapter2/maps/study.h"
#include "workspace/outline.h"

namespace flextip::reproduction {
namespace {

using Point = PointMeasures<2>;

double BetweenWorstDeg(const Point& at) {
  return AngleBetweenLines(at.step.v_sigma, at.angle.p_phi);
}
double PhiMaxDeg(const Point& at) { return kDegreesPerRad * at.angle.phi_max_rad; }
bool AtLowerLeft(const Eigen::Vector2d& p) { return p.x() < 0.18 && p.y() < -0.19; }
bool AroundPort(const Eigen::Vector2d& p) {
  return (p - PlanarInstrument{}.p_port).norm() < 0.11 && p.y() > -0.06;
}

/// Every point of the line that is at least `every_m` from the last one taken.
std::vector<Eigen::Vector2d> Evenly(const std::vector<Eigen::Vector2d>& line, double every_m) {
  std::vector<Eigen::Vector2d> taken;
  for (const auto& p : line)
    if (taken.empty() || (p - taken.back()).norm() >= every_m) taken.push_back(p);
  return taken;
}

/// Just inside the workspace's boundary.
struct EdgePoint {
  Point at;
  Eigen::Vector2d normal;
  double along_shaft_deg = 0.0;  ///< angle between v_sigma and the believed shaft
};

std::vector<EdgePoint> EdgePoints() {
  constexpr double kEvery_m = 0.004, kInward_m = 0.002;
  const MapSetup<2> setup = ThesisSetup(kThesisError);
  TrueShaft<2> shaft(setup.truth, setup.force);
  const auto outline = Evenly(TipOutline(setup.truth, 0.001), kEvery_m);
  std::vector<EdgePoint> edge;
  for (std::size_t i = 1; i + 1 < outline.size(); ++i) {
    const Eigen::Vector2d along = (outline[i + 1] - outline[i - 1]).normalized();
    const Eigen::Vector2d normal(along.y(), -along.x());
    for (const double side : {kInward_m, -kInward_m}) {
      const Point at = MeasureAt(setup, shaft, Eigen::Vector2d(outline[i] + side * normal));
      if (!at.A) continue;
      const Eigen::Vector2d believed = setup.truth.p_port + kThesisError - at.state->p_wrist;
      edge.push_back({at, normal, AngleBetweenLines(at.step.v_sigma, believed)});
      break;
    }
  }
  return edge;
}

/// Of v_sigma to the boundary's normal, over the part of the edge that `where` holds for.
template <class Where, class Value>
double MedianOverEdge(const std::vector<EdgePoint>& edge, Where where, Value value) {
  std::vector<double> values;
  for (const auto& point : edge)
    if (where(point.at)) values.push_back(value(point));
  return Quantile(values, 0.5);
}

std::vector<TableRow> StudyEdge() {
  const auto edge = EdgePoints();
  const auto off_normal = [](const EdgePoint& point) {
    return AngleBetweenLines(point.at.step.v_sigma, point.normal);
  };
  const auto outer = [](const Point& at) {
    return !AroundPort(at.p_tip) && !AtLowerLeft(at.p_tip);
  };
  const auto near_wrist = [](const Point& at) {
    return (at.state->p_wrist - PlanarInstrument{}.p_port).norm() < 0.06;
  };
  const auto arc = [&](const Point& at) { return outer(at) && near_wrist(at); };
  const auto sides = [&](const Point& at) { return outer(at) && !near_wrist(at); };
  return {{"2.3.1 v_sigma to the edge's normal, median, without the lower left and around the port",
           0.0, MedianOverEdge(edge, outer, off_normal), "deg",
           "The thesis: approximately perpendicular to the boundary."},
          {"2.3.1 v_sigma to the edge's normal, left and upper left side, median", 0.0,
           MedianOverEdge(edge, sides, off_normal), "deg", "Here it is."},
          {"2.3.1 v_sigma to the edge's normal, arc at the right and bottom, median", 0.0,
           MedianOverEdge(edge, arc, off_normal), "deg",
           "Here, where the errors are largest, it is not."},
          {"2.3.1 v_sigma to the believed shaft on that arc, median",
           {},
           MedianOverEdge(edge, arc, [](const EdgePoint& point) { return point.along_shaft_deg; }),
           "deg",
           "Why: a motion along the shaft as the controller believes it swings the true one, and "
           "with the "
           "wrist near the port the two are up to 53 degrees apart."},
          {"2.3.1 v_sigma to the edge's normal, lower left, median",
           {},
           MedianOverEdge(
               edge, [](const Point& at) { return AtLowerLeft(at.p_tip); }, off_normal),
           "deg",
           "The thesis: not perpendicular here."}};
}

/// Whether the tip is within `margin` of the workspace's boundary.
class NearEdge {
 public:
  explicit NearEdge(double margin_m) : outline_(TipOutline({}, 0.002)), margin_m_(margin_m) {}
  bool operator()(const Point& at) const {
    return std::any_of(outline_.begin(), outline_.end(),
                       [&](const auto& p) { return (p - at.p_tip).norm() < margin_m_; });
  }

 private:
  std::vector<Eigen::Vector2d> outline_;
  double margin_m_;
};

/// How much a better gain would lower ||G||: the least over all gains is sin |phi_max|.
double GainsUse(const Point& at) {
  const double phi = std::min(at.angle.phi_max_rad, std::numbers::pi / 2.0);
  return at.step.norm - std::sin(phi);
}

/// Largest of both measures with the tip on a line through both ports.
struct OnLine {
  double norm = 0.0, phi_deg = 0.0, along_deg = 0.0;
};
OnLine LargestOnLine(const NamedError& error) {
  const MapSetup<2> setup = ThesisSetup(error.port_error_m);
  TrueShaft<2> shaft(setup.truth, setup.force);
  const Eigen::Vector2d line = error.port_error_m.normalized();
  OnLine largest;
  for (double r = -0.3; r < 0.3; r += 0.0005) {
    if (std::abs(r) < 0.06) continue;
    const Point at = MeasureAt(setup, shaft, Eigen::Vector2d(setup.truth.p_port + r * line));
    if (!at.A) continue;
    largest.norm = std::max(largest.norm, at.step.norm);
    largest.phi_deg = std::max(largest.phi_deg, PhiMaxDeg(at));
    largest.along_deg = std::max(
        largest.along_deg, kDegreesPerRad * DirectionError<2>(*at.A, line, MotionFault::kAngle));
  }
  constexpr double kRounding_deg = 1e-9;
  if (largest.along_deg < kRounding_deg) largest.along_deg = 0.0;
  return largest;
}

std::vector<TableRow> StudyLines() {
  std::vector<TableRow> rows;
  for (const auto& error : FourErrors()) {
    const OnLine on = LargestOnLine(error);
    const std::string where =
        std::string(" on the line through the ports, error ") + error.in_words;
    rows.push_back(
        {"2.3.1 largest |phi_max|" + where, 0.0, on.phi_deg, "deg",
         "Not none: on the line the believed lever has the right direction and the wrong "
         "length. Tips more than 60 mm from the port."});
    rows.push_back({"2.3.1 largest ||G||" + where, 0.0, on.norm, "", ""});
    rows.push_back({"2.3.1 largest angle of a motion along the line" + where, 0.0, on.along_deg,
                    "deg", "Along the line, and square to it, the angle is exactly zero."});
  }
  return rows;
}

}  // namespace

std::vector<TableRow> StudyDirections(const WorkspaceMap<2>& map) {
  const NearEdge edge(0.015);
  const auto lower_left = [](const Point& at) { return AtLowerLeft(at.p_tip); };
  const auto rest = [&](const Point& at) {
    return !edge(at) && !AtLowerLeft(at.p_tip) && !AroundPort(at.p_tip);
  };
  const auto all = [](const Point&) { return true; };
  std::vector<TableRow> rows = StudyEdge();
  const std::vector<TableRow> more{
      {"2.3.1 p_phi to v_sigma, mean over the workspace",
       {},
       Mean(Collect(map, all, BetweenWorstDeg)),
       "deg",
       "The thesis: similar."},
      {"2.3.1 p_phi to v_sigma, away from edge, port and lower left",
       {},
       Mean(Collect(map, rest, BetweenWorstDeg)),
       "deg",
       ""},
      {"2.3.1 p_phi to v_sigma, within 15 mm of the edge",
       {},
       Mean(Collect(map, edge, BetweenWorstDeg)),
       "deg",
       "The thesis: differences here"},
      {"2.3.1 p_phi to v_sigma, lower left",
       {},
       Mean(Collect(map, lower_left, BetweenWorstDeg)),
       "deg",
       "and here."},
      {"2.4 p_phi to v_sigma where another gain lowers ||G|| by more than 0.2",
       {},
       Mean(Collect(
           map, [](const Point& at) { return GainsUse(at) > 0.2; }, BetweenWorstDeg)),
       "deg",
       "The thesis: the differences occur where a change of gain helps."},
      {"2.4 p_phi to v_sigma where it lowers it by less than 0.05",
       {},
       Mean(Collect(
           map, [](const Point& at) { return GainsUse(at) < 0.05; }, BetweenWorstDeg)),
       "deg",
       ""}};
  rows.insert(rows.end(), more.begin(), more.end());
  return rows;
}

std::vector<TableRow> StudyFourErrors(const std::vector<WorkspaceMap<2>>& maps) {
  const auto bottom = [](const Point& at) { return BearingDeg(at) < -60.0; };
  const auto right = [](const Point& at) {
    return std::abs(BearingDeg(at)) < 20.0 && at.p_tip.x() > 0.35;
  };
  const auto both = [&](std::size_t a, std::size_t b, auto where) {
    return 0.5 *
           (Mean(Collect(maps[a], where, PhiMaxDeg)) + Mean(Collect(maps[b], where, PhiMaxDeg)));
  };
  const auto height_mm = [&](std::size_t i) {
    const auto bad = [](const Point& at) { return PhiMaxDeg(at) > 45.0 && at.p_tip.x() > 0.30; };
    return 1000.0 * Mean(Collect(maps[i], bad, [](const Point& at) { return at.p_tip.y(); }));
  };
  double least = 1e9;
  for (const auto& map : maps)
    for (const auto& at : map.points)
      if (at.A) least = std::min(least, at.step.phi_hat_max_rad - at.angle.phi_max_rad);
  std::vector<TableRow> rows{
      {"Fig. 2.6 least bound minus phi_max over all four",
       {},
       kDegreesPerRad * least,
       "deg",
       "Conservative everywhere if not negative."},
      {"Fig. 2.6 |phi_max| at the bottom, errors in z, mean",
       {},
       both(0, 1, bottom),
       "deg",
       "The thesis: z errors are worse at the bottom. Bottom: more than 60 degrees below the "
       "port."},
      {"Fig. 2.6 |phi_max| at the bottom, errors in y, mean", {}, both(2, 3, bottom), "deg", ""},
      {"Fig. 2.6 |phi_max| at the right, errors in z, mean",
       {},
       both(0, 1, right),
       "deg",
       "The thesis: y errors are worse at the right. Right: within 20 degrees of the port's "
       "height, "
       "z > 350 mm."},
      {"Fig. 2.6 |phi_max| at the right, errors in y, mean", {}, both(2, 3, right), "deg", ""},
      {"Fig. 2.6 middle height of |phi_max| > 45 deg at the right, error +y",
       {},
       height_mm(2),
       "mm",
       "The thesis: +y moves the region of high errors down against -y. z > 300 mm."},
      {"Fig. 2.6 middle height of |phi_max| > 45 deg at the right, error -y",
       {},
       height_mm(3),
       "mm",
       ""}};
  const auto lines = StudyLines();
  rows.insert(rows.end(), lines.begin(), lines.end());
  return rows;
}

}  // namespace flextip::reproduction
