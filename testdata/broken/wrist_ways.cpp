#include <utility>

#include "testdata/broken/changes.h"
#include "testdata/broken/groups.h"

namespace flextip::broken {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

}  // namespace

std::vector<BrokenWay> WristWays() {
  return {
      {"wrist0 in mm",
       "wrist0.unit",
       {"wrist0.q"},
       [](Recording& r, Rng&) { EachWrist(r, [](Vector3d& p, Quaterniond&) { p *= 1e3; }); }},
      {"wrist0 quaternion xyzw",
       "wrist0.quaternion_order",
       {"wrist0.q"},
       [](Recording& r, Rng&) {
         EachWrist(r, [](Vector3d&, Quaterniond& q) { q = InOrderXyzw(q); });
       }},
      {"wrist0 quaternion inverted",
       "wrist0.quaternion_inverse",
       {"wrist0.q"},
       [](Recording& r, Rng&) {
         EachWrist(r, [](Vector3d&, Quaterniond& q) { q = q.conjugate(); });
       }},
      {"wrist0 pose inverted",
       "wrist0.inverse",
       {"wrist0.q", "end"},
       [](Recording& r, Rng&) { EachWrist(r, Invert); }},
      {"wrist0 z along the shaft",
       "wrist0.axis",
       {"wrist0.q"},
       [](Recording& r, Rng&) { EachWrist(r, [](Vector3d&, Quaterniond& q) { AxisZ(q); }); }},
      {"wrist0 y mirrored",
       "wrist0.mirrored",
       {"wrist0.q", "end"},
       [](Recording& r, Rng&) { EachWrist(r, MirrorY); }},
      {"wrist0 columns x and y",
       "wrist0.columns",
       {"wrist0.q", "end"},
       [](Recording& r, Rng&) {
         EachWrist(r, [](Vector3d& p, Quaterniond&) { std::swap(p.x(), p.y()); });
       }},
      {"wrist0 in the camera's frame",
       "wrist0.frame",
       {"wrist0.q", "cam0", "end"},
       [](Recording& r, Rng&) { EachWrist(r, InCamera(r)); }},
      {"wrist0 clock by hours",
       "wrist0.clock",
       {"wrist0", "em0", "vision0"},
       [](Recording& r, Rng& rng) {
         ShiftTimes(r.wrist0->samples, Either(rng, kHour_s * std::round(Uniform(rng, 1.0, 9.0))));
       }},
      {"wrist0 clock by seconds",
       "wrist0.clock",
       {"wrist0", "em0", "vision0"},
       [](Recording& r, Rng& rng) {
         ShiftTimes(r.wrist0->samples, Either(rng, Uniform(rng, 0.6, 3.0)));
       }},
      {"wrist0 times in ms",
       "wrist0.time_unit",
       {"wrist0"},
       [](Recording& r, Rng&) { DivideTimes(r.wrist0->samples, 1000000); }},
      {"wrist0 frozen",
       "wrist0.frozen",
       {"wrist0", "end"},
       [](Recording& r, Rng& rng) { Freeze(r.wrist0->samples, Uniform(rng, 0.3, 0.7)); }},
      {"wrist0 gap",
       "wrist0.gap",
       {"wrist0", "end"},
       [](Recording& r, Rng& rng) {
         const double from = Uniform(rng, 0.2, 0.6);
         CutOut(r.wrist0->samples, from, from + Uniform(rng, 0.08, 0.2));
       }},
      {"wrist0 rate",
       "wrist0.rate",
       {"wrist0"},
       [](Recording& r, Rng& rng) { r.wrist0->rate_hz *= Uniform(rng, 1.3, 2.5); }},
      {"wrist0 noise above",
       "wrist0.noise",
       {"wrist0.q"},
       [](Recording& r, Rng& rng) {
         const double sd = Uniform(rng, 5.0, 12.0) * r.wrist0->position_noise_m;
         EachWrist(r, [&](Vector3d& p, Quaterniond&) { p += sd * Normal(rng); });
       }},
      {"command0 in mm",
       "command0.unit",
       {"command0"},
       [](Recording& r, Rng&) {
         for (auto& s : r.command0->p_RW) s.value *= 1e3;
       }},
      {"command0 y mirrored",
       "command0.mirrored",
       {"command0"},
       [](Recording& r, Rng&) {
         for (auto& s : r.command0->p_RW) s.value.y() = -s.value.y();
       }},
      {"command0 clock by seconds",
       "command0.clock",
       {"command0"},
       [](Recording& r, Rng& rng) {
         ShiftTimes(r.command0->p_RW, Either(rng, Uniform(rng, 0.6, 3.0)));
       }},
  };
}

}  // namespace flextip::broken
