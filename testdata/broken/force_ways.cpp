#include <utility>

#include "testdata/broken/changes.h"
#include "testdata/broken/groups.h"

namespace flextip::broken {
std::vector<BrokenWay> ForceWays() {
  return {
      {"strain0 in N mm",
       "strain0.unit",
       {"strain0", "wrist0.q", "end"},
       [](Recording& r, Rng&) { EachMoment(r, [](Eigen::Vector4d& m) { m *= 1e3; }); }},
      {"strain0 sign",
       "strain0.sign",
       {"strain0", "wrist0.q", "end"},
       [](Recording& r, Rng&) { EachMoment(r, [](Eigen::Vector4d& m) { m = -m; }); }},
      {"strain0 y and z swapped",
       "strain0.columns",
       {"strain0", "wrist0.q", "end"},
       [](Recording& r, Rng&) {
         EachMoment(r, [](Eigen::Vector4d& m) { std::swap(m[0], m[1]), std::swap(m[2], m[3]); });
       }},
      {"strain0 stations' columns swapped",
       "strain0.stations",
       {"strain0", "wrist0.q", "end"},
       [](Recording& r, Rng&) {
         EachMoment(r, [](Eigen::Vector4d& m) { std::swap(m[0], m[2]), std::swap(m[1], m[3]); });
       }},
      {"strain0 stations beyond the shaft",
       "strain0.stations",
       {"strain0"},
       [](Recording& r, Rng& rng) {
         r.strain0->station_from_wrist_m[1] = Uniform(rng, 1.05, 2.0) * r.instrument.length_m;
       }},
      {"strain0 stations swapped",
       "strain0.stations",
       {"strain0"},
       [](Recording& r, Rng&) {
         std::swap(r.strain0->station_from_wrist_m[0], r.strain0->station_from_wrist_m[1]);
       }},
      {"strain0 stations in mm",
       "strain0.stations",
       {"strain0"},
       [](Recording& r, Rng&) {
         for (double& s : r.strain0->station_from_wrist_m) s *= 1e3;
       }},
      {"strain0 frozen",
       "strain0.frozen",
       {"strain0", "end"},
       [](Recording& r, Rng& rng) { Freeze(r.strain0->moments_Nm, Uniform(rng, 0.3, 0.7)); }},
      {"strain0 noise below",
       "strain0.noise",
       {"strain0"},
       [](Recording& r, Rng& rng) { r.strain0->moment_noise_Nm *= Uniform(rng, 5.0, 12.0); }},
      {"strain0 clock by seconds",
       "strain0.clock",
       {"strain0", "wrist0.q", "end"},
       [](Recording& r, Rng& rng) {
         ShiftTimes(r.strain0->moments_Nm, Either(rng, Uniform(rng, 1.0, 3.0)));
       }},
      {"strain0 repeated",
       "strain0.repeated",
       {"strain0"},
       [](Recording& r, Rng&) { Repeat(r.strain0->moments_Nm, 4); }},
      {"load0 clock by seconds",
       "load0.clock",
       {"load0", "strain0", "wrist0.q", "end"},
       [](Recording& r, Rng& rng) {
         ShiftTimes(r.load0->f_tip_N, Either(rng, Uniform(rng, 1.0, 3.0)));
       }},
      {"load0 frozen",
       "load0.frozen",
       {"load0", "end"},
       [](Recording& r, Rng& rng) { Freeze(r.load0->f_tip_N, Uniform(rng, 0.3, 0.7)); }},
      {"load0 gap",
       "load0.gap",
       {"load0"},
       [](Recording& r, Rng& rng) {
         const double from = Uniform(rng, 0.2, 0.6);
         CutOut(r.load0->f_tip_N, from, from + Uniform(rng, 0.08, 0.2));
       }},
      {"strain0 clock by hours",
       "strain0.clock",
       {"strain0", "end"},
       [](Recording& r, Rng&) { ShiftTimes(r.strain0->moments_Nm, kHour_s); }},
      {"load0 in grams",
       "load0.unit",
       {"load0", "strain0", "wrist0.q", "end"},
       [](Recording& r, Rng&) { EachLoad(r, 1e3 / 9.81); }},
      {"load0 in mN",
       "load0.unit",
       {"load0", "strain0", "wrist0.q", "end"},
       [](Recording& r, Rng&) { EachLoad(r, 1e3); }},
      {"load0 sign",
       "load0.sign",
       {"load0", "strain0", "wrist0.q", "end"},
       [](Recording& r, Rng&) { EachLoad(r, -1.0); }},
      {"load0 clock from 0",
       "load0.clock",
       {"load0"},
       [](Recording& r, Rng&) {
         ShiftTimes(r.load0->f_tip_N, -1e-9 * static_cast<double>(r.load0->f_tip_N.front().t_ns));
       }},
      {"load0 of hundreds of N",
       "load0.large",
       {"load0"},
       [](Recording& r, Rng&) {
         r.strain0.reset(), r.em0.reset(), r.em1.reset(), r.vision0.reset();
         EachLoad(r, 1e3);
       }},
  };
}

}  // namespace flextip::broken
