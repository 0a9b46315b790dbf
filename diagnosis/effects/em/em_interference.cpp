#include "diagnosis/effects/periodic.h"
#include "diagnosis/model/catalogue.h"

namespace flextip::diagnosis {
namespace {

/// Faster than breath and the motion, up to half the rate of the samples.
class EmInterference : public PeriodicEffect {
 public:
  EmInterference()
      : PeriodicEffect("em_interference", "a motor or a mains harmonic swings the EM position",
                       {.first_input = sample_input::kEmOffset,
                        .tolerance = 0.00005,
                        .typical = 0.001,
                        .lowest_hz = 1.0,
                        .highest_hz = 30.0,
                        .start_hz = 5.0}) {}
  bool Applies(const SampleSet& samples) const override {
    return samples.has_em && samples.resolved_in_time && samples.Duration() > 4.0;
  }
};

}  // namespace

std::unique_ptr<Effect> MakeEmInterference() { return std::make_unique<EmInterference>(); }

}  // namespace flextip::diagnosis
