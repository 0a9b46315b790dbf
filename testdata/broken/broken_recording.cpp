#include "testdata/broken/broken_recording.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "testdata/broken/changes.h"
#include "testdata/broken/groups.h"

namespace flextip::broken {
namespace {

bool Has(const Recording& r, const std::string& stream) {
  if (stream == "wrist0") return r.wrist0.has_value();
  if (stream == "wrist0.q") return r.wrist0 && r.wrist0->samples.front().value.q_RW;
  if (stream == "command0") return r.command0.has_value();
  if (stream == "em0") return r.em0.has_value();
  if (stream == "em1") return r.em1.has_value();
  if (stream == "strain0") return r.strain0.has_value();
  if (stream == "load0") return r.load0.has_value();
  if (stream == "cam0") return r.cam0.has_value();
  if (stream == "vision0") return r.vision0.has_value();
  if (stream == "tags0") return r.tags0.has_value();
  if (stream == "end") return r.em0 || r.vision0;  // a sensor at the shaft's end
  return false;
}

}  // namespace

const std::vector<BrokenWay>& BrokenWays() {
  static const std::vector<BrokenWay> all = [] {
    std::vector<BrokenWay> ways;
    for (auto& part :
         {EmWays(), WristWays(), VisionWays(), CameraWays(), SettingWays(), ForceWays()})
      ways.insert(ways.end(), part.begin(), part.end());
    return ways;
  }();
  return all;
}

bool Applies(const BrokenWay& way, const Recording& recording, bool hung_mass) {
  return std::all_of(way.needs.begin(), way.needs.end(), [&](const std::string& need) {
    return need == "hung mass" ? hung_mass : Has(recording, need);
  });
}

Recording BreakRecording(const Recording& recording, const BrokenWay& way, Rng& rng) {
  Recording broken = recording;
  way.make(broken, rng);
  return broken;
}

void AddFurtherStreams(Recording& r, Rng& rng) {
  if (r.em0 && r.wrist0 && r.wrist0->samples.front().value.q_RW) {
    r.em1 = *r.em0;
    r.em1->comment = "em port";
    r.em1->distance_from_tip_m = 0.0;
    r.em1->samples.clear();
    const std::size_t n = std::min(r.em0->samples.size(), r.wrist0->samples.size());
    for (std::size_t i = 0; i < n; ++i) {
      const WristSample& wrist = r.wrist0->samples[i].value;
      const double part = std::min(1.0, (r.p_RP - wrist.p_RW).norm() / r.instrument.length_m);
      // Between the noises of both: half of its own comes on top.
      const Eigen::Vector3d turn = 0.5 * r.em1->orientation_noise_rad * Normal(rng);
      const Eigen::Quaterniond q =
          wrist.q_RW->slerp(part, r.em0->samples[i].value.q_RS) *
          Eigen::Quaterniond(1.0, turn.x() / 2, turn.y() / 2, turn.z() / 2);
      r.em1->samples.push_back({r.em0->samples[i].t_ns,
                                {r.p_RP + r.em1->position_noise_m * Normal(rng), q.normalized()}});
    }
  }
  if (r.wrist0) {
    r.command0.emplace();
    r.command0->comment = "commanded";
    r.command0->rate_hz = r.wrist0->rate_hz;
    for (std::size_t i = 0; i + 2 < r.wrist0->samples.size(); ++i)
      r.command0->p_RW.push_back({r.wrist0->samples[i].t_ns, r.wrist0->samples[i + 2].value.p_RW});
  }
  r.tags0.emplace();
  for (int id = 0; id < 6; ++id) {
    const double angle = id * std::numbers::pi / 3.0;
    CollarTag tag;
    tag.id = id;
    tag.size_m = 0.005;
    const double s = std::sin(angle), c = std::cos(angle);
    tag.T_EG.p = {-0.03, 0.005 * s, 0.005 * c};
    tag.T_EG.R << 1, 0, 0, 0, -c, -s, 0, s, -c;  // z into the tag, toward the shaft
    r.tags0->tags.push_back(tag);
  }
}

}  // namespace flextip::broken
