#include <utility>

#include "testdata/broken/changes.h"
#include "testdata/broken/groups.h"

namespace flextip::broken {
namespace {

using Eigen::Vector3d;

}  // namespace

std::vector<BrokenWay> SettingWays() {
  return {
      {"port in mm", "port.unit", {"wrist0"}, [](Recording& r, Rng&) { r.p_RP *= 1e3; }},
      {"port elsewhere",
       "port.place",
       {"wrist0.q", "end"},
       [](Recording& r, Rng& rng) {
         Vector3d off = Normal(rng);
         off.x() = 0.2 * off.x();
         r.p_RP += Uniform(rng, 0.05, 0.12) * off.normalized();
       }},
      {"length in mm",
       "instrument.length_unit",
       {},
       [](Recording& r, Rng&) { r.instrument.length_m *= 1e3; }},
      {"length too short",
       "instrument.length",
       {"wrist0.q", "end"},
       [](Recording& r, Rng& rng) { r.instrument.length_m *= Uniform(rng, 0.86, 0.9); }},
      {"stiffness in N mm2",
       "instrument.stiffness",
       {},
       [](Recording& r, Rng&) { r.instrument.bending_stiffness_Nm2 *= 1e6; }},
      {"diameter in mm",
       "instrument.diameter_unit",
       {},
       [](Recording& r, Rng&) { r.instrument.outer_diameter_m *= 1e3; }},
      {"gravity in g",
       "gravity.unit",
       {},
       [](Recording& r, Rng&) { r.gravity_m_s2 /= r.gravity_m_s2.norm(); }},
      {"gravity far from 9.81",
       "gravity.size",
       {},
       [](Recording& r, Rng& rng) { r.gravity_m_s2 *= Uniform(rng, 0.3, 0.8); }},
      {"gravity upward",
       "gravity.sign",
       {"hung mass", "load0"},
       [](Recording& r, Rng&) { r.gravity_m_s2 = -r.gravity_m_s2; }},
  };
}

}  // namespace flextip::broken
