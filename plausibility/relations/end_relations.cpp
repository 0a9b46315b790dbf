#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/linear_algebra.h"
#include "core/median.h"
#include "core/rotation.h"
#include "plausibility/relations/relations.h"
#include "plausibility/relations/shaft_curve.h"

namespace flextip::plausibility {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

// Limits of the plausible: above those of recordings with strong effects. Shares of the length.
constexpr double kPlaceShare = 0.25, kCurveShare = 0.05, kBesidePortShare = 0.03;
constexpr double kPortPlace_m = 0.012, kSensors_m = 0.025;
constexpr double kEndAxis_rad = 0.8, kPortAxis_rad = 0.35, kSensors_rad = 0.25, kTwist_rad = 0.35;
constexpr double kTurn_rad = 0.35, kSpreadRatio = 4.0;

/// A sensor at the shaft's end: em0, or the tip by vision.
struct EndSensor {
  std::string stream, turn;  ///< "em0", "em0.q"
  double from_wrist_m = 0.0, registration_m = 0.0;
  std::optional<Vector3d> (*place)(const Instant&);
  std::optional<Vector3d> (*direction)(const Instant&);
  std::optional<ShaftCurve> (*curve)(const Scene&, const Instant&);

  /// Returns what a relation in R is about that compares this sensor with the wrist.
  std::vector<std::string> About(std::vector<std::string> more) const {
    more.insert(more.begin(), {stream, stream + ".frame", "wrist0"});
    if (stream == "em0") more.emplace_back("em0.distance");
    return more;
  }
};

EndSensor EmSensor(const Scene& scene) {
  return {"em0",
          "em0.q",
          scene.EmAt(),
          scene.em0_registration_m,
          [](const Instant& i) { return i.em0 ? std::optional(i.em0->p) : std::nullopt; },
          [](const Instant& i) {
            return i.em0 && i.em0->q ? std::optional(ShaftAxis(*i.em0->q)) : std::nullopt;
          },
          CurveToEm};
}

EndSensor TipSensor(const Scene& scene) {
  return {"vision0",
          "vision0.d",
          scene.instrument.length_m,
          scene.tip_registration_m,
          [](const Instant& i) { return i.tip ? std::optional(i.tip->p) : std::nullopt; },
          [](const Instant& i) { return i.tip ? i.tip->d : std::nullopt; },
          CurveToTip};
}

/// Where the straight shaft has the sensor.
void AddPlace(const EndSensor& sensor, RelationList& list) {
  const Scene& scene = list.scene();
  const auto misses = ValuesOf(scene, [&](const Instant& now) -> std::optional<double> {
    const auto along = DirectionToPort(scene, now);
    const auto place = sensor.place(now);
    if (!place || !along) return {};
    return (*place - now.wrist->p - sensor.from_wrist_m * *along).norm();
  });
  if (misses.size() < kFewestInstants) return;
  const double limit = kPlaceShare * scene.instrument.length_m + 3.0 * sensor.registration_m;
  const double median = Median(misses);
  list.Add(sensor.stream + ".place", sensor.About({"port", "length"}), median / limit,
           fmt::format("{} is {} from its place on the straight shaft, up to {} is plausible",
                       sensor.stream, MetresText(median), MetresText(limit)));
}

void AddAxis(const EndSensor& sensor, RelationList& list) {
  const Scene& scene = list.scene();
  const auto angles = ValuesOf(scene, [&](const Instant& now) -> std::optional<double> {
    const auto along = DirectionToPort(scene, now);
    const auto direction = sensor.direction(now);
    if (!direction || !along) return {};
    return AngleBetween(*direction, *along);
  });
  if (angles.size() < kFewestInstants) return;
  const double angle = Median(angles);
  list.Add(sensor.stream + ".axis", sensor.About({sensor.turn, "port"}), angle / kEndAxis_rad,
           fmt::format("{} points {} off the shaft", sensor.stream, DegreesText(angle)));
}

/// A bent shaft of the stated length from the wrist through the port.
void AddCurve(const EndSensor& sensor, RelationList& list) {
  const Scene& scene = list.scene();
  std::vector<double> longer, beside;
  for (const Instant& now : scene.instants) {
    const auto curve = sensor.curve(scene, now);
    if (!curve) continue;
    longer.push_back(std::abs(curve->length_m - sensor.from_wrist_m));
    beside.push_back((curve->Nearest(scene.p_RP) - scene.p_RP).norm());
  }
  if (longer.size() < kFewestInstants) return;
  const double full = scene.instrument.length_m;
  const double limit = kCurveShare * full + 3.0 * sensor.registration_m;
  std::vector<std::string> about = sensor.About({sensor.turn, "wrist0.q", "length"});
  list.Add(sensor.stream + ".length", about, Median(longer) / limit,
           fmt::format("the bent shaft from wrist0 to {} is {} too long or too short, up to {} is "
                       "plausible",
                       sensor.stream, MetresText(Median(longer)), MetresText(limit)));
  about.emplace_back("port");
  const double port_limit = kBesidePortShare * full + kPortPlace_m + 3.0 * sensor.registration_m;
  list.Add(sensor.stream + ".port", about, Median(beside) / port_limit,
           fmt::format("the bent shaft from wrist0 to {} passes the port at {}, up to {} is "
                       "plausible",
                       sensor.stream, MetresText(Median(beside)), MetresText(port_limit)));
}

/// Both sensors have the same tip, and the same direction.
void AddBothEnds(RelationList& list) {
  const Scene& scene = list.scene();
  const auto misses = ValuesOf(scene, [&](const Instant& now) -> std::optional<double> {
    if (!now.em0 || !now.em0->q || !now.tip) return {};
    Vector3d along = ShaftAxis(*now.em0->q);
    if (now.tip->d) along = (along + *now.tip->d).normalized();
    return (now.tip->p - now.em0->p - scene.em0_from_tip_m * along).norm();
  });
  if (misses.size() < kFewestInstants) return;
  const double limit = kSensors_m + 3.0 * (scene.tip_registration_m + scene.em0_registration_m);
  const double median = Median(misses);
  std::vector<std::string> about{"em0",           "em0.frame", "vision0",
                                 "vision0.frame", "em0.q",     "vision0.d"};
  std::vector<std::string> about_place = about;
  about_place.emplace_back("em0.distance");
  list.Add("em0.vision0", about_place, median / limit,
           fmt::format("em0 and vision0 have the tip {} apart, up to {} is plausible",
                       MetresText(median), MetresText(limit)));
  const auto angles = ValuesOf(scene, [&](const Instant& now) -> std::optional<double> {
    if (!now.em0 || !now.em0->q || !now.tip || !now.tip->d) return {};
    return AngleBetween(*now.tip->d, ShaftAxis(*now.em0->q));
  });
  if (angles.size() < kFewestInstants) return;
  const double angle = Median(angles);
  list.Add("em0.vision0.axis", about, angle / kSensors_rad,
           fmt::format("the directions of em0 and vision0 are {} apart", DegreesText(angle)));
}

/// The shaft does not twist: the roll between wrist and sensor stays.
void AddTwist(RelationList& list) {
  Vector2d sum = Vector2d::Zero();
  std::vector<double> rolls;
  for (const Instant& now : list.scene().instants) {
    if (!now.em0 || !now.em0->q || !now.wrist->q) continue;
    const Matrix3d R_RW = now.wrist->q->toRotationMatrix();
    const Matrix3d R_RS = now.em0->q->toRotationMatrix();
    if (R_RW.col(0).dot(R_RS.col(0)) < -0.9) continue;
    const Matrix3d carried = RotationWithoutTwist(R_RW.col(0), R_RS.col(0)) * R_RW;
    const Matrix3d rest = carried.transpose() * R_RS;
    rolls.push_back(std::atan2(rest(2, 1) - rest(1, 2), rest(1, 1) + rest(2, 2)));
    sum += Vector2d(std::cos(rolls.back()), std::sin(rolls.back()));
  }
  if (rolls.size() < kFewestInstants) return;
  const double mean = std::atan2(sum.y(), sum.x());
  for (double& roll : rolls) roll = std::abs(std::remainder(roll - mean, 2.0 * std::numbers::pi));
  const double spread = Quantile(rolls, 0.75);
  list.Add("em0.twist", {"em0.q", "wrist0.q", "em0", "em0.frame", "wrist0"}, spread / kTwist_rad,
           fmt::format("em0 turns by {} about the shaft against the wrist, and a shaft does not "
                       "twist",
                       DegreesText(spread)));
}

void AddPortSensor(RelationList& list) {
  const Scene& scene = list.scene();
  const auto angles = ValuesOf(scene, [&](const Instant& now) -> std::optional<double> {
    const auto along = DirectionToPort(scene, now);
    if (!now.em1 || !now.em1->q || !along) return {};
    return AngleBetween(ShaftAxis(*now.em1->q), *along);
  });
  if (angles.size() < kFewestInstants) return;
  const double angle = Median(angles);
  list.Add("em1.axis", {"em1", "em1.q", "wrist0", "port"}, angle / kPortAxis_rad,
           fmt::format("em1's x axis points {} off the shaft at the port", DegreesText(angle)));
}

/// Returns the root mean square distance from the mean.
double SpreadOf(const std::vector<Vector3d>& places) {
  const double n = static_cast<double>(places.size());
  Vector3d mean = Vector3d::Zero();
  for (const Vector3d& p : places) mean += p / n;
  double squares = 0.0;
  for (const Vector3d& p : places) squares += (p - mean).squaredNorm() / n;
  return std::sqrt(squares);
}

/// Returns the root mean square angle between two bundles of directions after the rotation that
/// fits them best (Kabsch).
double AngleInAnyFrame(const std::vector<Vector3d>& a, const std::vector<Vector3d>& b) {
  Matrix3d H = Matrix3d::Zero();
  for (std::size_t i = 0; i < a.size(); ++i) H += b[i] * a[i].transpose();
  const Svd svd(H);
  Matrix3d flip = Matrix3d::Identity();
  flip(2, 2) = (svd.U * svd.V.transpose()).determinant();
  const Matrix3d R = svd.U * flip * svd.V.transpose();
  double squares = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double angle = AngleBetween(R * a[i], b[i]);
    squares += angle * angle / static_cast<double>(a.size());
  }
  return std::sqrt(squares);
}

/// A sensor whose frame is not known yet: how far it moves and how it turns are the same in every
/// frame.
void AddMotionInAnyFrame(RelationList& list) {
  const Scene& scene = list.scene();
  std::vector<Vector3d> places, expected, axes, to_port;
  for (const Instant& now : scene.instants) {
    const auto along = DirectionToPort(scene, now);
    if (!now.em0 || !along) continue;
    places.push_back(now.em0->p);
    expected.emplace_back(now.wrist->p + scene.EmAt() * *along);
    if (!now.em0->q) continue;
    axes.push_back(ShaftAxis(*now.em0->q));
    to_port.push_back(*along);
  }
  constexpr double kHardly_m = 0.02, kHardly = 0.1;
  const std::vector<std::string> about{"em0", "wrist0", "port", "length", "em0.distance"};
  if (places.size() >= kFewestInstants && SpreadOf(expected) > kHardly_m) {
    const double ratio = SpreadOf(places) / SpreadOf(expected);
    list.Add("em0.spread", about, std::abs(std::log(ratio)) / std::log(kSpreadRatio),
             fmt::format("em0 moves {:.3g} times as far as wrist and port make it move", ratio));
  }
  if (axes.size() >= kFewestInstants && SpreadOf(to_port) > kHardly) {
    const double angle = AngleInAnyFrame(axes, to_port);
    list.Add("em0.turn", {"em0", "em0.q", "wrist0", "port"}, angle / kTurn_rad,
             fmt::format("em0's x axis turns unlike the shaft, by {}, whatever its frame",
                         DegreesText(angle)));
  }
}

}  // namespace

void AddEndRelations(RelationList& list) {
  const Scene& scene = list.scene();
  for (const EndSensor& sensor : {EmSensor(scene), TipSensor(scene)}) {
    AddPlace(sensor, list);
    AddAxis(sensor, list);
    AddCurve(sensor, list);
  }
  AddBothEnds(list);
  AddTwist(list);
  AddPortSensor(list);
  if (scene.unknown.contains("em0.frame")) AddMotionInAnyFrame(list);
}

}  // namespace flextip::plausibility
