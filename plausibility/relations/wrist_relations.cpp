#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/median.h"
#include "plausibility/relations/relations.h"
#include "plausibility/relations/shaft_curve.h"

namespace flextip::plausibility {
namespace {

using Eigen::Vector3d;

// Limits of the plausible: above those of recordings with strong effects.
constexpr double kWristAxis_rad = 0.35, kTurnShare = 0.5, kCommand_m = 0.03, kMoveShare = 0.8;

/// Root of the mean squares of two motions about their means, and of their difference.
struct Motions {
  double a = 0.0, b = 0.0, difference = 0.0;
};

Motions CompareMotions(const std::vector<Vector3d>& a, const std::vector<Vector3d>& b) {
  const double n = static_cast<double>(a.size());
  Vector3d mean_a = Vector3d::Zero(), mean_b = Vector3d::Zero();
  for (std::size_t i = 0; i < a.size(); ++i) mean_a += a[i] / n, mean_b += b[i] / n;
  Motions m;
  for (std::size_t i = 0; i < a.size(); ++i) {
    m.a += (a[i] - mean_a).squaredNorm() / n;
    m.b += (b[i] - mean_b).squaredNorm() / n;
    m.difference += (a[i] - mean_a - b[i] + mean_b).squaredNorm() / n;
  }
  return {std::sqrt(m.a), std::sqrt(m.b), std::sqrt(m.difference)};
}

void AddMeetings(RelationList& list) {
  constexpr double kApart = 3.0;
  const Scene& scene = list.scene();
  if (scene.instants.size() < kFewestInstants) return;
  const auto meet = [&](const std::string& stream, auto has) {
    if (!scene.Has(stream)) return;
    const auto met = std::count_if(scene.instants.begin(), scene.instants.end(), has);
    if (met >= static_cast<std::ptrdiff_t>(kFewestInstants)) return;
    list.Add(stream + ".times", {stream}, kApart,
             fmt::format("{} has no samples at the times of wrist0", stream));
  };
  meet("em0", [](const Instant& i) { return i.em0.has_value(); });
  meet("em1", [](const Instant& i) { return i.em1.has_value(); });
  meet("strain0", [](const Instant& i) { return i.strain_Nm.has_value(); });
  meet("load0", [](const Instant& i) { return i.load_N.has_value(); });
  meet("command0", [](const Instant& i) { return i.command.has_value(); });
}

/// The shaft has to reach the port.
void AddReach(RelationList& list) {
  const Scene& scene = list.scene();
  const auto distances =
      ValuesOf(scene, [&](const Instant& now) { return (scene.p_RP - now.wrist->p).norm(); });
  if (distances.empty()) return;
  const double length = scene.instrument.length_m, median = Median(distances);
  list.Add("wrist0.reach", {"wrist0", "port", "length"}, median / length,
           fmt::format("the port is {} from the wrist, the shaft is {} long", MetresText(median),
                       MetresText(length)));
}

void AddAxis(RelationList& list) {
  const Scene& scene = list.scene();
  std::vector<Vector3d> axes, to_port;
  std::vector<double> angles;
  for (const Instant& now : scene.instants) {
    const auto direction = DirectionToPort(scene, now);
    if (!direction || !now.wrist->q) continue;
    axes.push_back(ShaftAxis(*now.wrist->q));
    to_port.push_back(*direction);
    angles.push_back(AngleBetween(axes.back(), to_port.back()));
  }
  if (axes.size() < 4) return;
  const std::vector<std::string> about{"wrist0.q", "wrist0", "port"};
  const double median = Median(angles);
  list.Add("wrist0.axis", about, median / kWristAxis_rad,
           fmt::format("wrist0's x axis points {} beside the port", DegreesText(median)));
  // Both turn alike, whatever constant lies between them.
  constexpr double kHardly_rad = 0.05;
  const Motions turn = CompareMotions(axes, to_port);
  if (turn.b < kHardly_rad) return;
  const double share = turn.difference / std::max(turn.a, turn.b);
  list.Add("wrist0.turn", about, share / kTurnShare,
           fmt::format("wrist0's x axis does not turn as the line from wrist to port does: {:.0f} "
                       "% of the turn differs",
                       100.0 * share));
}

void AddCommand(RelationList& list) {
  const Scene& scene = list.scene();
  std::vector<double> misses;
  std::vector<Vector3d> commanded, measured;
  for (const Instant& now : scene.instants) {
    if (!now.command) continue;
    commanded.push_back(*now.command);
    measured.push_back(now.wrist->p);
    misses.push_back((*now.command - now.wrist->p).norm());
  }
  if (misses.size() < kFewestInstants) return;
  const double median = Median(misses);
  list.Add("command0.wrist0", {"command0", "wrist0"}, median / kCommand_m,
           fmt::format("command0 is {} from wrist0, up to {} is plausible", MetresText(median),
                       MetresText(kCommand_m)));
  constexpr double kHardly_m = 0.005;
  const Motions moved = CompareMotions(commanded, measured);
  if (moved.b < kHardly_m) return;
  // A wrist is a step behind its command, and where a controller makes it tremble that is as far as
  // it moves in a step.
  constexpr double kBehind = 1.5;
  const double behind = kBehind * scene.wrist_step_m;
  const double beyond =
      std::sqrt(std::max(0.0, moved.difference * moved.difference - behind * behind));
  const double share = beyond / moved.b;
  list.Add("command0.move", {"command0", "wrist0"}, share / kMoveShare,
           fmt::format("command0 and wrist0 move unlike: {:.0f} % of the motion differs",
                       100.0 * share));
}

}  // namespace

void AddWristRelations(RelationList& list) {
  AddMeetings(list);
  AddReach(list);
  AddAxis(list);
  AddCommand(list);
}

}  // namespace flextip::plausibility
