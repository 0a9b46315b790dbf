// How well the sensors' frames are known in R: no effect that is ever the answer, but unknowns with
// the uncertainty that the recording states.
#pragma once

#include "diagnosis/model/effect.h"

namespace flextip::diagnosis {

class Registration : public DirectEffect {
 public:
  std::string Name() const override { return "registration"; }
  std::string Summary() const override { return "the sensors' frames in the robot's"; }
  bool Applies(const SampleSet& samples) const override;
  std::vector<FitParameter> Parameters(const SampleSet& samples) const override;
  void Apply(const double* theta, const Instant& now, EffectMemory& memory,
             InputChange& change) const override;

 protected:
  std::vector<Named> Names() const override;
};

}  // namespace flextip::diagnosis
