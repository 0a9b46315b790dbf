// The outside tracker's frame is off: what it says is turned and moved in R. An effect where it was
// registered; a nuisance where its file says how badly it is known.
#include <algorithm>

#include "arms/effects/effects.h"
#include "arms/effects/marker.h"

namespace flextip::arms {
namespace {

class Tracker : public PlainEffect {
 public:
  void ActOnPose(const ArmData&, const double* theta, PoseStage& stage) const override {
    for (int j = 0; j < 6; ++j) stage.Add(j, PoseStage::kTrackerRotation + j, theta[j]);
  }

 protected:
  std::vector<Named> Names(const ArmData&) const override {
    return {{"rotation_rad", 3}, {"translation_m", 3}};
  }
  static bool IsRegistered(const ArmData& data) {
    return data.registration_m <= 0.0 && data.registration_rad <= 0.0;
  }
};

class TrackerRegistration : public Tracker {
 public:
  std::string Name() const override { return "tracker_registration"; }
  std::string Summary() const override { return "the outside tracker's frame is off"; }
  bool Applies(const ArmData& data) const override { return data.pose.Any() && IsRegistered(data); }
  std::vector<FitParameter> Parameters(const ArmData& data) const override {
    std::vector<FitParameter> parameters;
    for (const double sd : ToleranceOf(data, "tracker_registration.rotation_rad", 0.001, 3))
      parameters.push_back({sd, 0.01});
    for (const double sd : ToleranceOf(data, "tracker_registration.translation_m", 0.0005, 3))
      parameters.push_back({sd, 0.005});
    return parameters;
  }
};

class TrackerPlace : public Tracker {
 public:
  std::string Name() const override { return "tracker_place"; }
  std::string Summary() const override { return "where the outside tracker stands"; }
  bool Applies(const ArmData& data) const override {
    return data.pose.Any() && !IsRegistered(data);
  }
  bool IsAnswer() const override { return false; }
  bool OwnInEach() const override { return true; }
  std::vector<FitParameter> Parameters(const ArmData& data) const override {
    // What is found from the poses first is fitted about that place.
    std::vector<FitParameter> parameters(3, {std::clamp(data.registration_rad, 1e-6, 0.3), 0.0});
    parameters.resize(6, {std::clamp(data.registration_m, 1e-7, 0.1), 0.0});
    return parameters;
  }
};

}  // namespace

std::unique_ptr<ArmEffect> MakeTrackerRegistration() {
  return std::make_unique<TrackerRegistration>();
}
std::unique_ptr<ArmEffect> MakeTrackerPlace() { return std::make_unique<TrackerPlace>(); }

}  // namespace flextip::arms
