#include "diagnosis/effects/delay.h"
#include "diagnosis/model/catalogue.h"

namespace flextip::diagnosis {
namespace {

class EmLatency : public DelayEffect {
 public:
  EmLatency() : DelayEffect("em_latency", "EM samples are stamped late", sample_input::kEmDelay) {}
};

}  // namespace

std::unique_ptr<Effect> MakeEmLatency() { return std::make_unique<EmLatency>(); }

}  // namespace flextip::diagnosis
