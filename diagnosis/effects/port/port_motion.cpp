#include "diagnosis/effects/periodic.h"
#include "diagnosis/model/catalogue.h"

namespace flextip::diagnosis {
namespace {

/// Breathing. Breath is no pure sine, so it has a first overtone.
class PortMotion : public PeriodicEffect {
 public:
  PortMotion()
      : PeriodicEffect("port_motion", "breathing moves the port",
                       {.first_input = sample_input::kPort,
                        .tolerance = 0.0001,
                        .typical = 0.002,
                        .lowest_hz = 0.08,
                        .highest_hz = 0.7,
                        .start_hz = 0.25,
                        .overtone = 0.2}) {}
  bool Applies(const SampleSet& samples) const override {
    return samples.resolved_in_time && samples.Duration() > 4.0;
  }
};

}  // namespace

std::unique_ptr<Effect> MakePortMotion() { return std::make_unique<PortMotion>(); }

}  // namespace flextip::diagnosis
