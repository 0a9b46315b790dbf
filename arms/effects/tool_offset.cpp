// The marker is not where it was said to be on the last link: an offset in the link's frame L.
#include "arms/effects/effects.h"
#include "arms/effects/marker.h"

namespace flextip::arms {
namespace {

class ToolOffset : public PlainEffect {
 public:
  std::string Name() const override { return "tool_offset"; }
  std::string Summary() const override { return "the marker is elsewhere on the last link"; }
  bool Applies(const ArmData& data) const override {
    return data.pose.Any() && !MarkerIsUnknown(data);
  }
  std::vector<FitParameter> Parameters(const ArmData& data) const override {
    std::vector<FitParameter> parameters;
    for (const double tolerance : ToleranceOf(data, "tool_offset.offset_m", 0.0002, 3))
      parameters.push_back({tolerance, 0.003});
    return parameters;
  }
  void ActOnPose(const ArmData&, const double* theta, PoseStage& stage) const override {
    for (int j = 0; j < 3; ++j) stage.Add(j, PoseStage::kMarker + j, theta[j]);
  }

 protected:
  std::vector<Named> Names(const ArmData&) const override { return {{"offset_m", 3}}; }
};

/// Where the marker sits is not known at all.
class MarkerPlace : public PlainEffect {
 public:
  std::string Name() const override { return "marker_place"; }
  std::string Summary() const override { return "where the marker sits on the last link"; }
  bool Applies(const ArmData& data) const override {
    return data.pose.Any() && MarkerIsUnknown(data);
  }
  bool IsAnswer() const override { return false; }
  bool OwnInEach() const override { return true; }
  std::vector<FitParameter> Parameters(const ArmData& data) const override {
    const double turn = data.has_orientation ? 0.3 : 1e-6;
    std::vector<FitParameter> parameters(3, {turn, 0.0});
    parameters.resize(6, {0.1, 0.0});
    return parameters;
  }
  void ActOnPose(const ArmData&, const double* theta, PoseStage& stage) const override {
    for (int j = 0; j < 6; ++j) stage.Add(j, PoseStage::kMarkerRotation + j, theta[j]);
  }

 protected:
  std::vector<Named> Names(const ArmData&) const override {
    return {{"rotation_rad", 3}, {"translation_m", 3}};
  }
};

}  // namespace

bool MarkerIsUnknown(const ArmData& data) {
  return !data.arm.T_LK && data.registration_m > kUnknownRegistration_m;
}

std::unique_ptr<ArmEffect> MakeToolOffset() { return std::make_unique<ToolOffset>(); }
std::unique_ptr<ArmEffect> MakeMarkerPlace() { return std::make_unique<MarkerPlace>(); }

}  // namespace flextip::arms
