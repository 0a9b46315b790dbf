#include "plausibility/relations.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "core/median.h"
#include "core/rotation.h"

namespace flextip::plausibility {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr int kCurvePoints = 24;
constexpr std::size_t kFewest = 6;  // instants that a relation needs
constexpr double kApart = 3.0;      // misfit of streams that never meet

double Angle(const Vector3d& a, const Vector3d& b) {
  const double norms = a.norm() * b.norm();
  if (!(norms > 0.0)) return 0.0;
  return std::acos(std::clamp(a.dot(b) / norms, -1.0, 1.0));
}

Vector3d Axis(const Eigen::Quaterniond& q) { return q * Vector3d::UnitX(); }

std::optional<Vector3d> Chord(const Scene& scene, const Instant& now) {
  const Vector3d to_port = scene.p_RP - now.wrist->p;
  const double norm = to_port.norm();
  if (!(norm > 1e-6)) return {};
  return Vector3d(to_port / norm);
}

std::vector<double> Collect(const Scene& scene,
                            const std::function<std::optional<double>(const Instant&)>& of) {
  std::vector<double> values;
  for (const Instant& now : scene.instants) {
    if (const auto value = of(now)) values.push_back(*value);
  }
  return values;
}

std::string Metres(double m) {
  if (std::abs(m) >= 1.0) return fmt::format("{:.3g} m", m);
  return fmt::format("{:.3g} mm", 1e3 * m);
}

std::string Degrees(double rad) { return fmt::format("{:.0f} degrees", rad * 180.0 / M_PI); }

/// Two series of vectors that ought to be the same.
struct Pairs {
  double rms_a = 0.0, rms_b = 0.0, rms_difference = 0.0;
  std::size_t count = 0;

  /// Returns the misfit: the difference over the larger, and how unlike their sizes are.
  double Misfit(double limit, double ratio_limit) const {
    const double larger = std::max(rms_a, rms_b), smaller = std::min(rms_a, rms_b);
    if (!(larger > 0.0)) return 0.0;
    const double ratio = std::log(larger / std::max(smaller, 1e-6 * larger));
    return std::max(rms_difference / (limit * larger), ratio / std::log(ratio_limit));
  }
};

template <class Vector>
Pairs Compare(const Scene& scene,
              const std::function<std::optional<Vector>(const Scene&, const Instant&)>& a,
              const std::function<std::optional<Vector>(const Scene&, const Instant&)>& b) {
  Pairs pairs;
  double aa = 0.0, bb = 0.0, dd = 0.0;
  for (const Instant& now : scene.instants) {
    const auto x = a(scene, now), y = b(scene, now);
    if (!x || !y) continue;
    ++pairs.count;
    aa += x->squaredNorm();
    bb += y->squaredNorm();
    dd += (*x - *y).squaredNorm();
  }
  if (pairs.count == 0) return pairs;
  const double n = static_cast<double>(pairs.count);
  pairs.rms_a = std::sqrt(aa / n);
  pairs.rms_b = std::sqrt(bb / n);
  pairs.rms_difference = std::sqrt(dd / n);
  return pairs;
}

/// Collects relations of one scene.
class Collector {
 public:
  explicit Collector(const Scene& scene) : scene_(scene) {}

  std::vector<Relation> Take() { return std::move(relations_); }

  void AddAll() {
    Meetings();
    WristReach();
    WristAxis();
    EmPlace();
    TipPlace();
    Curves();
    EmTip();
    Twist();
    PortSensor();
    Strain();
    Stations();
    Load();
    Camera();
    Command();
  }

 private:
  void Add(const std::string& name, std::vector<std::string> streams, double misfit,
           std::string text) {
    if (!std::isfinite(misfit)) misfit = 1e6;
    relations_.push_back({name, std::move(streams), misfit, std::move(text)});
  }

  void Meeting(const std::string& stream, std::size_t met) {
    if (!scene_.Has(stream) || scene_.instants.size() < kFewest || met >= kFewest) return;
    Add(stream + ".times", {stream}, kApart,
        fmt::format("{} has no samples at the times of wrist0", stream));
  }

  void Meetings() {
    const auto count = [&](auto has) {
      return static_cast<std::size_t>(
          std::count_if(scene_.instants.begin(), scene_.instants.end(), has));
    };
    Meeting("em0", count([](const Instant& i) { return i.em0.has_value(); }));
    Meeting("em1", count([](const Instant& i) { return i.em1.has_value(); }));
    Meeting("strain0", count([](const Instant& i) { return i.strain_Nm.has_value(); }));
    Meeting("load0", count([](const Instant& i) { return i.load_N.has_value(); }));
    Meeting("command0", count([](const Instant& i) { return i.command.has_value(); }));
  }

  /// The shaft has to reach the port.
  void WristReach() {
    const auto distances =
        Collect(scene_, [&](const Instant& now) { return (scene_.p_RP - now.wrist->p).norm(); });
    if (distances.empty()) return;
    const double length = scene_.instrument.length_m, median = Median(distances);
    Add("wrist0.reach", {"wrist0", "port", "length"}, median / length,
        fmt::format("the port is {} from the wrist, the shaft is {} long", Metres(median),
                    Metres(length)));
  }

  void WristAxis() {
    std::vector<Vector3d> axes, chords;
    for (const Instant& now : scene_.instants) {
      const auto chord = Chord(scene_, now);
      if (!chord || !now.wrist->q) continue;
      axes.push_back(Axis(*now.wrist->q));
      chords.push_back(*chord);
    }
    if (axes.size() < 4) return;
    std::vector<double> angles;
    for (std::size_t i = 0; i < axes.size(); ++i) angles.push_back(Angle(axes[i], chords[i]));
    const double median = Median(angles);
    Add("wrist0.axis", {"wrist0.q", "wrist0", "port"}, median / kWristAxis_rad,
        fmt::format("wrist0's x axis points {} beside the port", Degrees(median)));
    Follow("wrist0.turn", {"wrist0.q", "wrist0", "port"}, axes, chords,
           "wrist0's x axis does not turn as the line from wrist to port does");
  }

  /// Directions that ought to turn alike, whatever a constant between them.
  void Follow(const std::string& name, std::vector<std::string> streams,
              const std::vector<Vector3d>& a, const std::vector<Vector3d>& b,
              const std::string& text) {
    Vector3d mean_a = Vector3d::Zero(), mean_b = Vector3d::Zero();
    const double n = static_cast<double>(a.size());
    for (std::size_t i = 0; i < a.size(); ++i) mean_a += a[i] / n, mean_b += b[i] / n;
    double aa = 0.0, bb = 0.0, dd = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i) {
      aa += (a[i] - mean_a).squaredNorm() / n;
      bb += (b[i] - mean_b).squaredNorm() / n;
      dd += (a[i] - mean_a - b[i] + mean_b).squaredNorm() / n;
    }
    if (bb < 0.05 * 0.05) return;  // it hardly turns
    const double part = std::sqrt(dd / std::max(aa, bb));
    Add(name, std::move(streams), part / kTurn,
        fmt::format("{}: {:.0f} % of the turn differs", text, 100.0 * part));
  }

  void EmPlace() {
    const double length = scene_.instrument.length_m;
    const auto misses = Collect(scene_, [&](const Instant& now) -> std::optional<double> {
      const auto chord = Chord(scene_, now);
      if (!now.em0 || !chord) return {};
      return (now.em0->p - now.wrist->p - scene_.EmAt() * *chord).norm();
    });
    if (misses.size() < kFewest) return;
    const double limit = kPlace * length + 3.0 * scene_.em0_registration_m;
    const double median = Median(misses);
    Add("em0.place", {"em0", "wrist0", "port", "length", "em0.distance"}, median / limit,
        fmt::format("em0 is {} from its place on the straight shaft, up to {} is plausible",
                    Metres(median), Metres(limit)));
    std::vector<double> angles = Collect(scene_, [&](const Instant& now) -> std::optional<double> {
      const auto chord = Chord(scene_, now);
      if (!now.em0 || !now.em0->q || !chord) return {};
      return Angle(Axis(*now.em0->q), *chord);
    });
    if (angles.size() < kFewest) return;
    const double angle = Median(angles);
    Add("em0.axis", {"em0.q", "em0", "wrist0", "port"}, angle / kEndAxis_rad,
        fmt::format("em0's x axis points {} off the shaft", Degrees(angle)));
  }

  void TipPlace() {
    const double length = scene_.instrument.length_m;
    const auto misses = Collect(scene_, [&](const Instant& now) -> std::optional<double> {
      const auto chord = Chord(scene_, now);
      if (!now.tip || !chord) return {};
      return (now.tip->p - now.wrist->p - length * *chord).norm();
    });
    if (misses.size() < kFewest) return;
    const double limit = kPlace * length + 3.0 * scene_.tip_registration_m;
    const double median = Median(misses);
    Add("vision0.place", {"vision0", "wrist0", "port", "length"}, median / limit,
        fmt::format("vision0 has the tip {} from its place on the straight shaft, up to {} is "
                    "plausible",
                    Metres(median), Metres(limit)));
    const auto angles = Collect(scene_, [&](const Instant& now) -> std::optional<double> {
      const auto chord = Chord(scene_, now);
      if (!now.tip || !now.tip->d || !chord) return {};
      return Angle(*now.tip->d, *chord);
    });
    if (angles.size() < kFewest) return;
    const double angle = Median(angles);
    Add("vision0.axis", {"vision0.d", "vision0", "wrist0", "port"}, angle / kEndAxis_rad,
        fmt::format("vision0's direction points {} off the shaft", Degrees(angle)));
  }

  void Curve(const std::string& stream,
             std::optional<ShaftCurve> (*curve_of)(const Scene&, const Instant&), double length,
             double registration) {
    std::vector<double> longer, beside;
    for (const Instant& now : scene_.instants) {
      const auto curve = curve_of(scene_, now);
      if (!curve) continue;
      longer.push_back(std::abs(curve->length_m - length));
      beside.push_back((curve->Nearest(scene_.p_RP) - scene_.p_RP).norm());
    }
    if (longer.size() < kFewest) return;
    const double full = scene_.instrument.length_m;
    const double limit = kCurve * full + 3.0 * registration;
    std::vector<std::string> streams{stream, stream + ".q", "wrist0", "wrist0.q", "length"};
    if (stream == "em0") streams.push_back("em0.distance");
    Add(stream + ".length", streams, Median(longer) / limit,
        fmt::format("the bent shaft from wrist0 to {} is {} too long or too short, up to {} is "
                    "plausible",
                    stream, Metres(Median(longer)), Metres(limit)));
    streams.push_back("port");
    const double port_limit = kBesidePort * full + kPortPlace_m + 3.0 * registration;
    Add(stream + ".port", streams, Median(beside) / port_limit,
        fmt::format("the bent shaft from wrist0 to {} passes the port at {}, up to {} is plausible",
                    stream, Metres(Median(beside)), Metres(port_limit)));
  }

  void Curves() {
    Curve("em0", CurveToEm, scene_.EmAt(), scene_.em0_registration_m);
    Curve("vision0", CurveToTip, scene_.instrument.length_m, scene_.tip_registration_m);
  }

  void EmTip() {
    const auto misses = Collect(scene_, [&](const Instant& now) -> std::optional<double> {
      if (!now.em0 || !now.tip) return {};
      Vector3d along = Axis(*now.em0->q);
      if (now.tip->d) along = (along + *now.tip->d).normalized();
      return (now.tip->p - now.em0->p - scene_.em0_from_tip_m * along).norm();
    });
    if (misses.size() < kFewest) return;
    const double limit = kSensors_m + 3.0 * (scene_.tip_registration_m + scene_.em0_registration_m);
    const double median = Median(misses);
    Add("em0.vision0", {"em0", "vision0", "em0.distance", "em0.q", "vision0.d"}, median / limit,
        fmt::format("em0 and vision0 have the tip {} apart, up to {} is plausible", Metres(median),
                    Metres(limit)));
    const auto angles = Collect(scene_, [&](const Instant& now) -> std::optional<double> {
      if (!now.em0 || !now.tip || !now.tip->d) return {};
      return Angle(*now.tip->d, Axis(*now.em0->q));
    });
    if (angles.size() < kFewest) return;
    const double angle = Median(angles);
    Add("em0.vision0.axis", {"em0.q", "vision0.d", "em0", "vision0"}, angle / kSensors_rad,
        fmt::format("the directions of em0 and vision0 are {} apart", Degrees(angle)));
  }

  /// The shaft does not twist: the roll between wrist and sensor stays.
  void Twist() {
    Vector2d sum = Vector2d::Zero();
    std::vector<double> rolls;
    for (const Instant& now : scene_.instants) {
      if (!now.em0 || !now.em0->q || !now.wrist->q) continue;
      const Eigen::Matrix3d R_RW = now.wrist->q->toRotationMatrix();
      const Eigen::Matrix3d R_RS = now.em0->q->toRotationMatrix();
      if (R_RW.col(0).dot(R_RS.col(0)) < -0.9) continue;
      const Eigen::Matrix3d carried = RotationWithoutTwist(R_RW.col(0), R_RS.col(0)) * R_RW;
      const Eigen::Matrix3d rest = carried.transpose() * R_RS;
      rolls.push_back(std::atan2(rest(2, 1) - rest(1, 2), rest(1, 1) + rest(2, 2)));
      sum += Vector2d(std::cos(rolls.back()), std::sin(rolls.back()));
    }
    if (rolls.size() < kFewest) return;
    const double mean = std::atan2(sum.y(), sum.x());
    for (double& roll : rolls) roll = std::abs(std::remainder(roll - mean, 2.0 * M_PI));
    const double spread = Quantile(rolls, 0.75);
    Add("em0.twist", {"em0.q", "wrist0.q", "em0", "wrist0"}, spread / kTwist_rad,
        fmt::format("em0 turns by {} about the shaft against the wrist, and a shaft does not twist",
                    Degrees(spread)));
  }

  void PortSensor() {
    const auto angles = Collect(scene_, [&](const Instant& now) -> std::optional<double> {
      const auto chord = Chord(scene_, now);
      if (!now.em1 || !now.em1->q || !chord) return {};
      return Angle(Axis(*now.em1->q), *chord);
    });
    if (angles.size() < kFewest) return;
    const double angle = Median(angles);
    Add("em1.axis", {"em1", "em1.q", "wrist0", "port"}, angle / kWristAxis_rad,
        fmt::format("em1's x axis points {} off the shaft at the port", Degrees(angle)));
  }

  void Strain() {
    const auto turn = Compare<Vector2d>(scene_, TurnByMoments, TurnSeen);
    constexpr double kLeast_rad = 0.03;
    if (turn.count >= kFewest && std::max(turn.rms_a, turn.rms_b) > kLeast_rad) {
      Add("strain0.turn",
          {"strain0", "stiffness", "em0", "em0.q", "vision0", "vision0.d", "wrist0", "wrist0.q"},
          turn.Misfit(kMoments, kMomentRatio),
          fmt::format("the moments of strain0 turn the shaft by {:.3g} rad, the sensors see {:.3g} "
                      "rad, and {:.3g} rad lie between",
                      turn.rms_a, turn.rms_b, turn.rms_difference));
    }
  }

  /// Both stations tell the moment at the port.
  void Stations() {
    const auto of = [](bool first) {
      return [first](const Scene& scene, const Instant& now) -> std::optional<Vector2d> {
        if (!now.strain_Nm) return {};
        const double length = scene.instrument.length_m;
        const double s1 = scene.station_m[0], s2 = scene.station_m[1];
        const double port = (scene.p_RP - now.wrist->p).norm();
        if (!(s1 > 0.0) || !(s1 < port) || !(s2 > port) || !(s2 < length)) return {};
        if (first) return Vector2d(now.strain_Nm->head<2>() * port / s1);
        return Vector2d(now.strain_Nm->tail<2>() * (length - port) / (length - s2));
      };
    };
    const auto moments = Compare<Vector2d>(scene_, of(true), of(false));
    const double noise = std::max(20.0 * scene_.strain_noise_Nm, 1e-3);
    if (moments.count < kFewest || std::max(moments.rms_a, moments.rms_b) < noise) return;
    // Forces and moments between the stations part them too: only stations that fit far better
    // when exchanged are wrong.
    Scene exchanged = scene_;
    for (Instant& now : exchanged.instants) {
      if (!now.strain_Nm) continue;
      const Eigen::Vector4d m = *now.strain_Nm;
      now.strain_Nm = Eigen::Vector4d(m[2], m[3], m[0], m[1]);
    }
    const double misfit = moments.Misfit(kStations, kMomentRatio);
    const double other =
        Compare<Vector2d>(exchanged, of(true), of(false)).Misfit(kStations, kMomentRatio);
    Add("strain0.stations", {"strain0", "port", "wrist0", "length"},
        other < 0.5 * misfit ? misfit : std::min(misfit, 0.9),
        fmt::format(
            "the stations of strain0 make {:.3g} Nm and {:.3g} Nm of the moment at the port",
            moments.rms_a, moments.rms_b));
  }

  void Load() {
    const auto moment = Compare<Vector2d>(
        scene_, MomentByLoad, [](const Scene&, const Instant& now) -> std::optional<Vector2d> {
          if (!now.strain_Nm) return {};
          return Vector2d(now.strain_Nm->tail<2>());
        });
    const double noise = std::max(4.0 * scene_.strain_noise_Nm, 1e-4);
    if (moment.count >= kFewest && std::max(moment.rms_a, moment.rms_b) > noise) {
      Add("strain0.load0", {"strain0", "load0", "wrist0", "em0", "em0.q", "vision0.d", "wrist0.q"},
          moment.Misfit(kLoads, kLoadRatio),
          fmt::format("load0 makes {:.3g} Nm at the second station, strain0 has {:.3g} Nm, and "
                      "{:.3g} Nm lie between",
                      moment.rms_a, moment.rms_b, moment.rms_difference));
    }
    const auto bend = Compare<Vector3d>(scene_, DeflectionByLoad, DeflectionSeen);
    const double least = 0.02 * scene_.instrument.length_m + 3.0 * scene_.tip_registration_m;
    if (bend.count >= kFewest && bend.rms_a > least) {
      Add("load0.bend",
          {"load0", "vision0", "em0", "em0.q", "wrist0", "port", "stiffness", "length"},
          bend.Misfit(kBend, kBendRatio),
          fmt::format("load0 bends the tip by {}, the sensors see {}, and {} lie between",
                      Metres(bend.rms_a), Metres(bend.rms_b), Metres(bend.rms_difference)));
    }
  }

  /// The tip as far as it is known, else the straight shaft's.
  std::optional<Vector3d> TipFor(const Instant& now) const {
    if (now.tip) return now.tip->p;
    const auto chord = Chord(scene_, now);
    if (!chord) return {};
    return Vector3d(now.wrist->p + scene_.instrument.length_m * *chord);
  }

  void Camera() {
    if (!scene_.camera) return;
    const CameraCalibration& camera = *scene_.camera;
    const Pose T_CR = camera.T_RC.Inverse();
    std::size_t seen = 0, all = 0, behind = 0;
    for (const Instant& now : scene_.instants) {
      const auto tip = TipFor(now);
      if (!tip) continue;
      ++all;
      const Vector3d x = T_CR * *tip;
      if (x.z() <= 0.0) {
        ++behind;
        continue;
      }
      // Half a picture beyond each edge: lenses distort, and straight shafts are no bent ones.
      const double margin = now.tip ? 0.25 : 0.6;
      const double u = (camera.cu_px + camera.fu_px * x.x() / x.z()) / camera.width_px;
      const double v = (camera.cv_px + camera.fv_px * x.y() / x.z()) / camera.height_px;
      if (u > -margin && u < 1.0 + margin && v > -margin && v < 1.0 + margin && x.z() < 2.0) ++seen;
    }
    CameraSight(T_CR);
    if (all < 4) return;
    const double out = 1.0 - static_cast<double>(seen) / static_cast<double>(all);
    std::vector<std::string> streams{"cam0"};
    for (const char* stream : {"wrist0", "port", "length"})
      if (!scene_.Has("vision0")) streams.emplace_back(stream);
    if (scene_.Has("vision0")) streams.emplace_back("vision0");
    Add("cam0.view", streams, 2.0 * out,
        fmt::format("the tip is outside cam0's picture at {:.0f} % of the times, behind the camera "
                    "at {:.0f} %",
                    100.0 * out, 100.0 * static_cast<double>(behind) / static_cast<double>(all)));
  }

  /// Depth is what a camera knows worst: the covariance is longest along the line of sight.
  void CameraSight(const Pose& T_CR) {
    const auto angles = Collect(scene_, [&](const Instant& now) -> std::optional<double> {
      if (!now.tip || !now.tip->sight) return {};
      const double angle = Angle(T_CR.R * *now.tip->sight, T_CR * now.tip->p);
      return std::min(angle, M_PI - angle);
    });
    if (angles.size() < kFewest) return;
    const double angle = Median(angles);
    Add("cam0.sight", {"cam0", "vision0"}, angle / kSight_rad,
        fmt::format("vision0 is least certain along a line {} beside cam0's line of sight",
                    Degrees(angle)));
  }

  void Command() {
    const auto misses = Collect(scene_, [&](const Instant& now) -> std::optional<double> {
      if (!now.command) return {};
      return (*now.command - now.wrist->p).norm();
    });
    if (misses.size() < kFewest) return;
    const double median = Median(misses);
    Add("command0.wrist0", {"command0", "wrist0"}, median / kCommand_m,
        fmt::format("command0 is {} from wrist0, up to {} is plausible", Metres(median),
                    Metres(kCommand_m)));
    Vector3d mean_command = Vector3d::Zero(), mean_wrist = Vector3d::Zero();
    const double n = static_cast<double>(misses.size());
    for (const Instant& now : scene_.instants) {
      if (!now.command) continue;
      mean_command += *now.command / n, mean_wrist += now.wrist->p / n;
    }
    double own = 0.0, apart = 0.0;
    for (const Instant& now : scene_.instants) {
      if (!now.command) continue;
      own += (now.wrist->p - mean_wrist).squaredNorm() / n;
      apart += (*now.command - mean_command - now.wrist->p + mean_wrist).squaredNorm() / n;
    }
    if (own < 0.005 * 0.005) return;
    const double part = std::sqrt(apart / own);
    Add("command0.move", {"command0", "wrist0"}, part / kMove,
        fmt::format("command0 and wrist0 move unlike: {:.0f} % of the motion differs",
                    100.0 * part));
  }

  // Limits of the plausible, from recordings with strong effects (docs/usage/check.md).
  static constexpr double kWristAxis_rad = 0.35, kEndAxis_rad = 0.8;
  static constexpr double kTurn = 0.5;
  static constexpr double kPlace = 0.25, kCurve = 0.05, kBesidePort = 0.03, kPortPlace_m = 0.012;
  static constexpr double kSensors_m = 0.025, kSensors_rad = 0.25, kTwist_rad = 0.35;
  static constexpr double kMoments = 0.8, kMomentRatio = 4.0;
  static constexpr double kLoads = 0.6, kLoadRatio = 4.0, kBend = 1.1, kBendRatio = 8.0;
  static constexpr double kCommand_m = 0.03, kSight_rad = 0.75, kStations = 0.5, kMove = 0.8;

  const Scene& scene_;
  std::vector<Relation> relations_;
};

/// Where the shaft points at its far end.
std::optional<Vector3d> EndDirection(const Instant& now) {
  if (now.em0 && now.em0->q) return Axis(*now.em0->q);
  if (now.tip && now.tip->d) return *now.tip->d;
  return {};
}

}  // namespace

bool Relation::Names(const std::string& stream) const {
  return std::find(streams.begin(), streams.end(), stream) != streams.end();
}

std::vector<Relation> RelationsOf(const Scene& scene) {
  Collector collector(scene);
  collector.AddAll();
  return collector.Take();
}

double TotalMisfit(const std::vector<Relation>& relations) {
  constexpr double kMost = 8.0;
  double sum = 0.0;
  for (const Relation& r : relations) {
    const double m = std::min(r.misfit, kMost);
    sum += m * m;
  }
  return sum;
}

bool AnyViolated(const std::vector<Relation>& relations) {
  return std::any_of(relations.begin(), relations.end(),
                     [](const Relation& r) { return r.Violated(); });
}

const Relation* WorstOf(const std::vector<Relation>& relations, const std::string& stream) {
  const Relation* worst = nullptr;
  for (const Relation& r : relations) {
    if (!r.Violated() || (!stream.empty() && !r.Names(stream))) continue;
    if (worst == nullptr || r.misfit > worst->misfit) worst = &r;
  }
  return worst;
}

Vector3d ShaftCurve::Nearest(const Vector3d& p, Vector3d* along) const {
  Vector3d best = points.front();
  double least = (best - p).squaredNorm();
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    const Vector3d step = points[i + 1] - points[i];
    const double square = step.squaredNorm();
    if (!(square > 0.0)) continue;
    const double u = std::clamp((p - points[i]).dot(step) / square, 0.0, 1.0);
    const Vector3d at = points[i] + u * step;
    if ((at - p).squaredNorm() > least && i > 0) continue;
    least = (at - p).squaredNorm();
    best = at;
    if (along != nullptr) *along = step.normalized();
  }
  return best;
}

ShaftCurve CurveBetween(const Vector3d& p_begin, const Vector3d& d_begin, const Vector3d& p_end,
                        const Vector3d& d_end, double length_m) {
  ShaftCurve curve;
  const Vector3d a = length_m * d_begin, b = length_m * d_end;
  for (int i = 0; i <= kCurvePoints; ++i) {
    const double u = static_cast<double>(i) / kCurvePoints, v = 1.0 - u;
    curve.points.emplace_back((1.0 + 2.0 * u) * v * v * p_begin + u * v * v * a +
                              u * u * (3.0 - 2.0 * u) * p_end - u * u * v * b);
    if (i > 0) {
      curve.length_m +=
          (curve.points[curve.points.size() - 1] - curve.points[curve.points.size() - 2]).norm();
    }
  }
  return curve;
}

namespace {

/// Where the shaft leaves the wrist: as measured, else toward the port.
std::optional<Vector3d> BeginDirection(const Scene& scene, const Instant& now) {
  if (now.wrist->q) return Axis(*now.wrist->q);
  return Chord(scene, now);
}

}  // namespace

std::optional<ShaftCurve> CurveToEm(const Scene& scene, const Instant& now) {
  const auto begin = BeginDirection(scene, now);
  if (!begin || !now.em0 || !now.em0->q) return {};
  return CurveBetween(now.wrist->p, *begin, now.em0->p, Axis(*now.em0->q), scene.EmAt());
}

std::optional<ShaftCurve> CurveToTip(const Scene& scene, const Instant& now) {
  const auto begin = BeginDirection(scene, now);
  if (!begin || !now.tip || !now.tip->d) return {};
  return CurveBetween(now.wrist->p, *begin, now.tip->p, *now.tip->d, scene.instrument.length_m);
}

std::optional<Vector2d> TurnSeen(const Scene& /*scene*/, const Instant& now) {
  const auto end = EndDirection(now);
  if (!end || !now.wrist->q) return {};
  const Vector3d local = now.wrist->q->conjugate() * *end;
  const Vector3d turn = LogRotation(RotationWithoutTwist(
      Vector3d::UnitX(), local.x() > -0.95 ? local : Vector3d(Vector3d::UnitY())));
  return Vector2d(turn.y(), turn.z());
}

std::optional<Vector2d> TurnByMoments(const Scene& scene, const Instant& now) {
  if (!now.strain_Nm) return {};
  const double length = scene.instrument.length_m;
  const double s1 = scene.station_m[0], s2 = scene.station_m[1];
  const double port = std::clamp((scene.p_RP - now.wrist->p).norm(), 0.02 * length, 0.98 * length);
  if (!(s1 > 0.0) || !(s2 < length)) return {};
  const Vector2d m1 = now.strain_Nm->head<2>(), m2 = now.strain_Nm->tail<2>();
  // Nothing at the pinned wrist, nothing at the tip, straight lines to the port between.
  const auto at_port = [&](double s, const Vector2d& m) -> Vector2d {
    return s < port ? m * port / s : m * (length - port) / (length - s);
  };
  const Vector2d before = at_port(s1, m1), beyond = at_port(s2, m2);
  return Vector2d(0.5 * (before * port + beyond * (length - port)) /
                  scene.instrument.bending_stiffness_Nm2);
}

std::optional<Vector2d> MomentByLoad(const Scene& scene, const Instant& now) {
  const auto end = EndDirection(now);
  if (!now.load_N || !end || !now.wrist->q) return {};
  const Eigen::Matrix3d R_RW = now.wrist->q->toRotationMatrix();
  if (R_RW.col(0).dot(*end) < -0.9) return {};
  const Eigen::Matrix3d R = RotationWithoutTwist(R_RW.col(0), *end) * R_RW;
  const double arm = scene.instrument.length_m - scene.station_m[1];
  return Vector2d((R.transpose() * (arm * *end).cross(*now.load_N)).tail<2>());
}

std::optional<Vector3d> DeflectionSeen(const Scene& scene, const Instant& now) {
  const auto chord = Chord(scene, now);
  if (!chord) return {};
  Vector3d tip;
  if (now.tip) {
    tip = now.tip->p;
  } else if (now.em0 && now.em0->q) {
    tip = now.em0->p + scene.em0_from_tip_m * Axis(*now.em0->q);
  } else {
    return {};
  }
  const Vector3d off = tip - now.wrist->p;
  return Vector3d(off - off.dot(*chord) * *chord);
}

std::optional<Vector3d> DeflectionByLoad(const Scene& scene, const Instant& now) {
  const auto chord = Chord(scene, now);
  if (!chord || !now.load_N) return {};
  const double length = scene.instrument.length_m;
  const double beyond = length - (scene.p_RP - now.wrist->p).norm();
  if (!(beyond > 0.0)) return {};
  const Vector3d across = *now.load_N - now.load_N->dot(*chord) * *chord;
  return Vector3d(across * beyond * beyond * length /
                  (3.0 * scene.instrument.bending_stiffness_Nm2));
}

}  // namespace flextip::plausibility
