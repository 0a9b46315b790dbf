#include <utility>

#include "testdata/broken/changes.h"
#include "testdata/broken/groups.h"

namespace flextip::broken {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

}  // namespace

std::vector<BrokenWay> EmWays() {
  const auto scaled = [](double factor) {
    return [factor](Recording& r, Rng&) {
      EachEm(r, [&](Vector3d& p, Quaterniond&) { p *= factor; });
    };
  };
  return {
      {"em0 in mm", "em0.unit", {"em0"}, scaled(1e3)},
      {"em0 in cm", "em0.unit", {"em0"}, scaled(1e2)},
      {"em0 in inch", "em0.unit", {"em0"}, scaled(1.0 / 0.0254)},
      {"em0 quaternion xyzw",
       "em0.quaternion_order",
       {"em0"},
       [](Recording& r, Rng&) {
         EachEm(r, [](Vector3d&, Quaterniond& q) { q = InOrderXyzw(q); });
       }},
      {"em0 quaternion inverted",
       "em0.quaternion_inverse",
       {"em0"},
       [](Recording& r, Rng&) { EachEm(r, [](Vector3d&, Quaterniond& q) { q = q.conjugate(); }); }},
      {"em0 pose inverted", "em0.inverse", {"em0"}, [](Recording& r, Rng&) { EachEm(r, Invert); }},
      {"em0 z along the shaft",
       "em0.axis",
       {"em0"},
       [](Recording& r, Rng&) { EachEm(r, [](Vector3d&, Quaterniond& q) { AxisZ(q); }); }},
      {"em0 y mirrored", "em0.mirrored", {"em0"}, [](Recording& r, Rng&) { EachEm(r, MirrorY); }},
      {"em0 in the camera's frame",
       "em0.frame",
       {"em0", "cam0"},
       [](Recording& r, Rng&) { EachEm(r, InCamera(r)); }},
      {"em0 columns x and y",
       "em0.columns",
       {"em0"},
       [](Recording& r, Rng&) {
         EachEm(r, [](Vector3d& p, Quaterniond&) { std::swap(p.x(), p.y()); });
       }},
      {"em0 clock by hours",
       "em0.clock",
       {"em0"},
       [](Recording& r, Rng& rng) {
         ShiftTimes(r.em0->samples, Either(rng, kHour_s * std::round(Uniform(rng, 1.0, 9.0))));
       }},
      {"em0 clock from 0",
       "em0.clock",
       {"em0"},
       [](Recording& r, Rng&) {
         ShiftTimes(r.em0->samples, -1e-9 * static_cast<double>(r.em0->samples.front().t_ns));
       }},
      {"em0 clock by seconds",
       "em0.clock",
       {"em0"},
       [](Recording& r, Rng& rng) {
         ShiftTimes(r.em0->samples, Either(rng, Uniform(rng, 0.6, 3.0)));
       }},
      {"em0 clock by a third of the recording",
       "em0.clock",
       {"em0"},
       [](Recording& r, Rng& rng) {
         ShiftTimes(r.em0->samples, Either(rng, Uniform(rng, 0.3, 0.5) * DurationOf(r)));
       }},
      {"em0 times in us",
       "em0.time_unit",
       {"em0"},
       [](Recording& r, Rng&) { DivideTimes(r.em0->samples, 1000); }},
      {"em0 frozen",
       "em0.frozen",
       {"em0"},
       [](Recording& r, Rng& rng) { Freeze(r.em0->samples, Uniform(rng, 0.3, 0.7)); }},
      {"em0 repeated",
       "em0.repeated",
       {"em0"},
       [](Recording& r, Rng& rng) {
         Repeat(r.em0->samples, static_cast<std::size_t>(std::round(Uniform(rng, 2.0, 6.0))));
       }},
      {"em0 noise above",
       "em0.noise",
       {"em0"},
       [](Recording& r, Rng& rng) {
         const double sd = Uniform(rng, 5.0, 12.0) * r.em0->position_noise_m;
         EachEm(r, [&](Vector3d& p, Quaterniond&) { p += sd * Normal(rng); });
       }},
      {"em0 noise below",
       "em0.noise",
       {"em0"},
       [](Recording& r, Rng& rng) { r.em0->position_noise_m *= Uniform(rng, 5.0, 12.0); }},
      {"em0 rate",
       "em0.rate",
       {"em0"},
       [](Recording& r, Rng& rng) { r.em0->rate_hz *= Uniform(rng, 1.3, 2.5); }},
      {"em0 gap",
       "em0.gap",
       {"em0"},
       [](Recording& r, Rng& rng) {
         const double from = Uniform(rng, 0.2, 0.6);
         CutOut(r.em0->samples, from, from + Uniform(rng, 0.08, 0.2));
       }},
      {"em0 distance from the wrist",
       "em0.distance",
       {"em0"},
       [](Recording& r, Rng&) {
         r.em0->distance_from_tip_m = r.instrument.length_m - r.em0->distance_from_tip_m;
       }},
      {"em0 distance in mm",
       "em0.distance",
       {"em0"},
       [](Recording& r, Rng&) { r.em0->distance_from_tip_m *= 1e3; }},
      {"em0 and em1 swapped",
       "em0.swapped",
       {"em0", "em1"},
       [](Recording& r, Rng&) { std::swap(r.em0->samples, r.em1->samples); }},
      {"em1 quaternion xyzw",
       "em1.quaternion_order",
       {"em1"},
       [](Recording& r, Rng&) {
         for (auto& s : r.em1->samples) s.value.q_RS = InOrderXyzw(s.value.q_RS);
       }},
      {"em1 z along the shaft",
       "em1.axis",
       {"em1"},
       [](Recording& r, Rng&) {
         for (auto& s : r.em1->samples) AxisZ(s.value.q_RS);
       }},
  };
}

}  // namespace flextip::broken
