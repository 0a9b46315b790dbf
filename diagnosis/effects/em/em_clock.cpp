#include "diagnosis/effects/delay.h"
#include "diagnosis/model/catalogue.h"

namespace flextip::diagnosis {
namespace {

class EmClock : public ClockEffect {
 public:
  EmClock()
      : ClockEffect("em_clock", "the EM system runs by a clock of its own",
                    sample_input::kEmDelay) {}
};

}  // namespace

std::unique_ptr<Effect> MakeEmClock() { return std::make_unique<EmClock>(); }

}  // namespace flextip::diagnosis
