#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "plausibility/relations/bending.h"
#include "plausibility/relations/relations.h"

namespace flextip::plausibility {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

// Limits of the plausible: above those of recordings with strong effects. Shares of the larger, and
// ratios of both.
constexpr double kMomentShare = 0.8, kMomentRatio = 4.0, kStationShare = 0.5;
constexpr double kLoadShare = 0.6, kLoadRatio = 4.0, kBendShare = 1.1, kBendRatio = 8.0;

template <class Vector>
using OfInstant = std::function<std::optional<Vector>(const Scene&, const Instant&)>;

/// Two series of vectors that ought to be the same: roots of their mean squares.
struct Pairs {
  double a = 0.0, b = 0.0, difference = 0.0;
  std::size_t count = 0;

  double Larger() const { return std::max(a, b); }
  /// Returns the misfit: the difference over the larger, or how unlike their sizes are.
  double Misfit(double share_limit, double ratio_limit) const {
    if (!(Larger() > 0.0)) return 0.0;
    const double ratio = Larger() / std::max(std::min(a, b), 1e-6 * Larger());
    return std::max(difference / (share_limit * Larger()), std::log(ratio) / std::log(ratio_limit));
  }
};

template <class Vector>
Pairs Compare(const Scene& scene, const OfInstant<Vector>& a, const OfInstant<Vector>& b) {
  Pairs pairs;
  for (const Instant& now : scene.instants) {
    const auto x = a(scene, now), y = b(scene, now);
    if (!x || !y) continue;
    ++pairs.count;
    pairs.a += x->squaredNorm(), pairs.b += y->squaredNorm();
    pairs.difference += (*x - *y).squaredNorm();
  }
  const double n = static_cast<double>(std::max<std::size_t>(pairs.count, 1));
  pairs.a = std::sqrt(pairs.a / n), pairs.b = std::sqrt(pairs.b / n);
  pairs.difference = std::sqrt(pairs.difference / n);
  return pairs;
}

void AddTurn(RelationList& list) {
  constexpr double kLeast_rad = 0.03;
  const Pairs turn = Compare<Vector2d>(list.scene(), TurnByMoments, TurnSeen);
  if (turn.count < kFewestInstants || turn.Larger() < kLeast_rad) return;
  list.Add("strain0.turn",
           {"strain0", "stiffness", "em0", "em0.q", "em0.frame", "vision0", "vision0.d",
            "vision0.frame", "wrist0", "wrist0.q", "port", "length"},
           turn.Misfit(kMomentShare, kMomentRatio),
           fmt::format("the moments of strain0 turn the shaft by {:.3g} rad, the sensors see "
                       "{:.3g} rad, and {:.3g} rad lie between",
                       turn.a, turn.b, turn.difference));
}

/// The moment at the port by one station.
OfInstant<Vector2d> PortMoment(bool first) {
  return [first](const Scene& scene, const Instant& now) -> std::optional<Vector2d> {
    if (!now.strain_Nm) return {};
    const double length = scene.instrument.length_m;
    const double s1 = scene.station_m[0], s2 = scene.station_m[1];
    const double port = (scene.p_RP - now.wrist->p).norm();
    if (!(s1 > 0.0) || !(s1 < port) || !(s2 > port) || !(s2 < length)) return {};
    if (first) return Vector2d(now.strain_Nm->head<2>() * port / s1);
    return Vector2d(now.strain_Nm->tail<2>() * (length - port) / (length - s2));
  };
}

/// Both stations tell the moment at the port. Forces between them part them too: only stations that
/// fit far better when exchanged are wrong.
void AddStations(RelationList& list) {
  const Scene& scene = list.scene();
  const Pairs moments = Compare<Vector2d>(scene, PortMoment(true), PortMoment(false));
  const double noise = std::max(20.0 * scene.strain_noise_Nm, 1e-3);
  if (moments.count < kFewestInstants || moments.Larger() < noise) return;
  Scene exchanged = scene;
  for (Instant& now : exchanged.instants) {
    if (!now.strain_Nm) continue;
    const Eigen::Vector4d m = *now.strain_Nm;
    now.strain_Nm = Eigen::Vector4d(m[2], m[3], m[0], m[1]);
  }
  const double misfit = moments.Misfit(kStationShare, kMomentRatio);
  const double other = Compare<Vector2d>(exchanged, PortMoment(true), PortMoment(false))
                           .Misfit(kStationShare, kMomentRatio);
  list.Add("strain0.stations", {"strain0", "port", "wrist0", "length"},
           other < 0.5 * misfit ? misfit : std::min(misfit, 0.9),
           fmt::format("the stations of strain0 make {:.3g} Nm and {:.3g} Nm of the moment at the "
                       "port",
                       moments.a, moments.b));
}

void AddLoadMoment(RelationList& list) {
  const Scene& scene = list.scene();
  const auto second = [](const Scene&, const Instant& now) -> std::optional<Vector2d> {
    if (!now.strain_Nm) return {};
    return Vector2d(now.strain_Nm->tail<2>());
  };
  const Pairs moment = Compare<Vector2d>(scene, MomentByLoad, second);
  // Moments that hardly bend the shaft can be of its weight or of tissue on it.
  constexpr double kHardly_rad = 0.01;
  const double hardly_Nm =
      kHardly_rad * scene.instrument.bending_stiffness_Nm2 / scene.instrument.length_m;
  const double least = std::max({4.0 * scene.strain_noise_Nm, 1e-4, hardly_Nm});
  if (moment.count < kFewestInstants || moment.Larger() < least) return;
  list.Add("strain0.load0",
           {"strain0", "load0", "wrist0", "em0", "em0.q", "em0.frame", "vision0.d", "vision0.frame",
            "wrist0.q", "length"},
           moment.Misfit(kLoadShare, kLoadRatio),
           fmt::format("load0 makes {:.3g} Nm at the second station, strain0 has {:.3g} Nm, and "
                       "{:.3g} Nm lie between",
                       moment.a, moment.b, moment.difference));
}

void AddBend(RelationList& list) {
  const Scene& scene = list.scene();
  const Pairs bend = Compare<Vector3d>(scene, DeflectionByLoad, DeflectionSeen);
  const double least = 0.02 * scene.instrument.length_m + 3.0 * scene.tip_registration_m;
  if (bend.count < kFewestInstants || bend.a < least) return;
  list.Add("load0.bend",
           {"load0", "vision0", "vision0.frame", "em0", "em0.q", "em0.frame", "wrist0", "port",
            "stiffness", "length"},
           bend.Misfit(kBendShare, kBendRatio),
           fmt::format("load0 bends the tip by {}, the sensors see {}, and {} lie between",
                       MetresText(bend.a), MetresText(bend.b), MetresText(bend.difference)));
}

}  // namespace

void AddForceRelations(RelationList& list) {
  AddTurn(list);
  AddStations(list);
  AddLoadMoment(list);
  AddBend(list);
}

}  // namespace flextip::plausibility
