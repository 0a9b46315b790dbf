#include "diagnosis/effects/watched.h"

#include "diagnosis/model/catalogue.h"

namespace flextip::diagnosis {
namespace {

class EmOffset : public DirectEffect {
 public:
  std::string Name() const override { return "em_offset"; }
  std::string Summary() const override { return "the EM sensor reads another place"; }
  bool Applies(const SampleSet& samples) const override { return samples.has_em; }
  std::vector<FitParameter> Parameters(const SampleSet& samples) const override {
    return WithTypical(ToleranceOf(samples, Name(), "offset_m", 0.0002, 3), 0.003);
  }
  void Apply(const double*, const Instant&, EffectMemory&, InputChange& change) const override {
    for (int i = 0; i < 3; ++i) change.Linear(i, sample_input::kEmShift + i, 1.0);
  }

 protected:
  std::vector<Named> Names() const override { return {{"offset_m", 3}}; }
};

class StrainOffset : public DirectEffect {
 public:
  std::string Name() const override { return "strain_offset"; }
  std::string Summary() const override { return "the gages' zero has moved"; }
  bool Applies(const SampleSet& samples) const override { return samples.has_strain; }
  std::vector<FitParameter> Parameters(const SampleSet& samples) const override {
    return WithTypical(ToleranceOf(samples, Name(), "offset_Nm", 0.0002, 4), 0.01);
  }
  void Apply(const double*, const Instant&, EffectMemory&, InputChange& change) const override {
    for (int i = 0; i < 4; ++i) change.Linear(i, sample_input::kStrainOffset + i, 1.0);
  }

 protected:
  std::vector<Named> Names() const override { return {{"offset_Nm", 4}}; }
};

constexpr const char* kTurned = "the port resists the turning of the shaft";

constexpr WatchedEffect kWatched[] = {
    {MakePortCompliance, "the port yields more than the model says", "mm/N", 1e3},
    {MakePortOffset, "the port is not where it was", "mm", 1e3, 0, 0, 3},
    {MakeStiffness, "the shaft is stiffer (softer where negative) than the model says", "%", 100.0},
    {MakeEmOffset, "the EM sensor reads another place", "mm", 1e3, 0, 0, 3},
    {MakeHandEye, "the camera is not where it was registered", "mm", 1e3, 0, 3, 3},
    {MakeTagOffset, "the tags are not where they were on the tip", "mm", 1e3, 0, 0, 3},
    {MakePrecurvature, "the shaft is bent without a load", "1/m", 1.0, 0, 0, 2},
    {MakePortFriction, "the shaft rubs in the port", "N/N", 1.0},
    {MakePortMoment, kTurned, "Nm", 1.0, 0, 0, 3},
    {MakeShaftLoad, "something pushes on the shaft beyond the port", "N/m", 1.0, 0, 0, 3},
    {MakeWristCompliance, "the arm yields under the wrist's force", "mm/N", 1e3},
    {MakeTipCompliance, "the tip yields under its force", "mm/N", 1e3},
    {MakeBacklash, "there is play between the measured and the true wrist", "mm", 1e3, 1},
    {MakeEmLatency, "the EM sensor is later than stated", "ms", 1e3},
    {MakeCameraLatency, "the tip by vision is later than stated", "ms", 1e3},
    {MakeStrainGain, "the gages read by another factor", "%", 100.0, 0, 0, 4},
    {MakeStrainOffset, "the gages' zero has moved", "mNm", 1e3, 0, 0, 4},
    {MakeStrainDrift},
    {MakeLength},
    {MakeSelfWeight},
    {MakeHandEye, "the tip by vision drifts", "mm/s", 1e3, 0, 3, 3, "tip_drift"},
    {MakeEmOffset, "the EM sensor drifts", "mm/s", 1e3, 0, 0, 3, "em_drift"},
};

}  // namespace

std::unique_ptr<Effect> MakeEmOffset() { return std::make_unique<EmOffset>(); }
std::unique_ptr<Effect> MakeStrainOffset() { return std::make_unique<StrainOffset>(); }

std::span<const WatchedEffect> WatchedEffects() { return kWatched; }

}  // namespace flextip::diagnosis
