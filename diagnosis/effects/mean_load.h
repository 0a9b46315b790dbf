// The slow part of an unknown tip force: no effect that is ever the answer. Each sample's force is
// free, but along the shaft, where it hardly shows, its prior draws it towards its mean; were that
// zero, a thousand small pulls would add up to a bias of whatever stiffens or bends the shaft.
#pragma once

#include "diagnosis/model/effect.h"

namespace flextip::diagnosis {

/// In units of the shaft's EI / L^2: a constant in R, and slow waves along the shaft.
class MeanLoad : public DirectEffect {
 public:
  std::string Name() const override { return "mean_load"; }
  std::string Summary() const override { return "the slow part of the unknown tip force"; }
  bool Applies(const SampleSet& samples) const override { return !samples.has_load; }
  std::vector<FitParameter> Parameters(const SampleSet& samples) const override;
  void Apply(const double* theta, const Instant& now, EffectMemory& memory,
             InputChange& change) const override;

 protected:
  std::vector<Named> Names() const override;
};

}  // namespace flextip::diagnosis
