#include "arms/held_shaft/held_shaft.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "arms/effects/effects.h"
#include "arms/held_shaft/wrist_effects.h"
#include "core/error.h"

namespace flextip::arms {
namespace {

constexpr double kAtPort_rad = 0.35;  // off the port that the link of a shaft may point
constexpr double kFollows = 0.7;      // of the port's direction's motion that it then makes, too
constexpr double kFarApart_m = 0.001;
constexpr double kLeastNoise = 1e-7;  // m, rad

double MedianOf(std::vector<double> values) {
  const auto middle = values.begin() + std::ptrdiff_t(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// How a link's direction goes with that to the port.
struct Pointing {
  double off_rad = 0.0;  ///< the median between them
  double follows = 0.0;  ///< how much of the port's direction's motion the link makes; 0: no motion
};

Pointing PointingOf(const std::vector<Eigen::Vector3d>& links,
                    const std::vector<Eigen::Vector3d>& to_port) {
  Eigen::Vector3d mean_link = Eigen::Vector3d::Zero(), mean_port = mean_link;
  std::vector<double> off_rad;
  for (std::size_t k = 0; k < links.size(); ++k) {
    mean_link += links[k] / double(links.size());
    mean_port += to_port[k] / double(links.size());
    off_rad.push_back(std::acos(std::clamp(links[k].dot(to_port[k]), -1.0, 1.0)));
  }
  double with = 0.0, squares = 0.0;
  for (std::size_t k = 0; k < links.size(); ++k) {
    with += (links[k] - mean_link).dot(to_port[k] - mean_port);
    squares += (to_port[k] - mean_port).squaredNorm();
  }
  return {MedianOf(std::move(off_rad)), squares > 0.0 ? with / squares : 0.0};
}

/// Standard deviations of the wrist per axis, by those of the joints: of place and turn.
std::pair<double, double> WristNoise(const Recording& recording, const ArmData& data) {
  const std::vector<double>& noise = recording.joints0->noise;
  double place2 = 0.0, turn2 = 0.0;
  for (Eigen::Index k = 0; k < data.joints.Rows(); ++k) {
    const WristByJoints wrist(data, data.joints.values.row(k).transpose());
    for (int j = 0; j < data.Size(); ++j) {
      place2 += (wrist.J.col(j).head<3>() * noise[std::size_t(j)]).squaredNorm() / 3.0;
      turn2 += (wrist.J.col(j).tail<3>() * noise[std::size_t(j)]).squaredNorm() / 3.0;
    }
  }
  const auto rows = double(data.joints.Rows());
  return {std::max(kLeastNoise, std::sqrt(place2 / rows)),
          std::max(kLeastNoise, std::sqrt(turn2 / rows))};
}

template <class Make>
void Add(diagnosis::EffectMakers& makers, const std::shared_ptr<const HeldArm>& arm, Make make) {
  makers.push_back([arm, make] { return MakeWristEffect(arm, make()); });
}

}  // namespace

bool HoldsShaft(const Recording& recording) {
  return recording.joints0 && !recording.joints0->q.empty() && recording.has_shaft &&
         (recording.em0 || recording.vision0 || recording.strain0);
}

HeldShaft::HeldShaft(Recording recording, const std::string& name)
    : recording_(std::move(recording)) {
  const TimeNs start_ns = recording_.joints0->q.front().t_ns;
  if (recording_.wrist0) LeaveOutWithoutJoints(name);
  const bool has_wrist = recording_.wrist0 && !recording_.wrist0->samples.empty();
  const double wrist_starts_s =
      has_wrist ? 1e-9 * double(recording_.wrist0->samples.front().t_ns - start_ns) : 0.0;
  arm_ = std::make_shared<HeldArm>(HeldArm{ArmData(recording_, name), wrist_starts_s});
  has_wrist ? CompareWrist() : MakeWrist();
}

/// Where the joints are is known between their first and last row alone.
void HeldShaft::LeaveOutWithoutJoints(const std::string& name) {
  constexpr TimeNs kNear_ns = 20'000'000;
  const auto& joints = recording_.joints0->q;
  auto& samples = recording_.wrist0->samples;
  const std::size_t all = samples.size();
  std::erase_if(samples, [&](const auto& sample) {
    return sample.t_ns < joints.front().t_ns - kNear_ns ||
           sample.t_ns > joints.back().t_ns + kNear_ns;
  });
  if (samples.size() == all) return;
  if (samples.empty()) throw InputError(name + ": joints0 and wrist0 are of different times");
  warnings_.push_back(
      fmt::format("{} of {} samples of wrist0 are before or after joints0: left out",
                  all - samples.size(), all));
}

void HeldShaft::MakeWrist() {
  WristStream wrist;
  wrist.comment = "by the arm's joints";
  wrist.rate_hz = recording_.joints0->rate_hz;
  std::tie(wrist.position_noise_m, wrist.orientation_noise_rad) = WristNoise(recording_, Data());
  std::vector<Eigen::Vector3d> links, to_port;
  for (const auto& row : recording_.joints0->q) {
    const Pose T_RW = WristByJoints(Data(), row.value).T_RW;
    wrist.samples.push_back({row.t_ns, {T_RW.p, T_RW.Quaternion()}});
    links.emplace_back(T_RW.R.col(0));
    to_port.emplace_back((recording_.p_RP - T_RW.p).normalized());
  }
  const Pointing pointing = PointingOf(links, to_port);
  if (pointing.off_rad > kAtPort_rad || std::abs(pointing.follows - 1.0) > 1.0 - kFollows) {
    for (auto& sample : wrist.samples) sample.value.q_RW.reset();
    warnings_.push_back(fmt::format(
        "the last link's x axis is {:.2g} rad off the port in the middle, and follows its "
        "direction "
        "by {:.2g} of the way: the shaft's orientation at the wrist is taken as unknown",
        pointing.off_rad, pointing.follows));
  }
  recording_.wrist0 = std::move(wrist);
}

void HeldShaft::CompareWrist() {
  const TimeNs start_ns = recording_.joints0->q.front().t_ns;
  std::vector<double> apart_m;
  for (const auto& sample : recording_.wrist0->samples) {
    const Where where = WhereAt(Data().joints, 1e-9 * double(sample.t_ns - start_ns));
    const WristByJoints wrist(Data(), At(Data().joints.values, where).transpose());
    apart_m.push_back((sample.value.p_RW - wrist.T_RW.p).norm());
  }
  const double apart = MedianOf(std::move(apart_m));
  if (apart <= kFarApart_m) return;
  warnings_.push_back(
      fmt::format("wrist0 is {:.3g} mm from where joints0 and arm.yaml have it, in the middle: the "
                  "wrist is taken from wrist0, what moves it from the joints",
                  1e3 * apart));
}

diagnosis::EffectMakers HeldShaft::Effects(const std::shared_ptr<const HeldArm>& arm) {
  const ArmData& data = arm->data;
  diagnosis::EffectMakers makers;
  Add(makers, arm, MakeJointOffset);
  Add(makers, arm, MakeJointScale);
  if (data.Size() > 1) Add(makers, arm, MakeJointCoupling);
  if (data.Size() <= kMostJointsOfPlay) makers.push_back([arm] { return MakeWristPlay(arm); });
  const auto& known = data.effort_known;
  if (std::ranges::find(known, true) != known.end()) Add(makers, arm, MakeJointCompliance);
  if (data.arm.convention != ArmConvention::kUrdf)
    makers.push_back([arm] { return MakeWristGeometry(arm); });
  return makers;
}

diagnosis::EffectMakers HeldShaft::EffectsFrom(TimeNs zero_ns) const {
  const TimeNs start_ns = recording_.joints0->q.front().t_ns;
  return Effects(std::make_shared<HeldArm>(HeldArm{arm_->data, 1e-9 * double(zero_ns - start_ns)}));
}

std::vector<std::string> HeldShaft::Names() const {
  std::vector<std::string> names;
  for (const auto& make : Effects()) names.push_back(make()->Name());
  return names;
}

}  // namespace flextip::arms
