#include "apps/common/input/command_uses.h"

namespace flextip {
namespace {

using plausibility::CommandUse;
using plausibility::Subjects;

/// What holds of the shaft, in R.
const Subjects kShaft{"wrist0", "port", "instrument", "gravity"};

Subjects With(Subjects subjects, const Subjects& more) {
  subjects.insert(more.begin(), more.end());
  return subjects;
}

}  // namespace

// The pictures alone measure the tip. Wrist and shaft say where it is while it hides; the other
// sensors sharpen that.
CommandUse UseOfTrack(bool with_model) {
  const Subjects seen{"cam0", "cam1", "tags0"};
  if (!with_model) return {"track", seen, {}};
  return {"track", With(kShaft, seen), {"em0", "em1", "strain0", "load0"}};
}

// cam0 counts by the tips that were tracked with it.
CommandUse UseOfEstimate() {
  return {
      "estimate", With(kShaft, {"em0", "em1", "strain0", "load0", "vision0", "cam0.identity"}), {}};
}

CommandUse UseOfDiagnose() {
  return {"diagnose", With(kShaft, {"em0", "em1", "strain0", "load0", "vision0", "cam0"}), {}};
}

CommandUse UseOfPredict() {
  CommandUse use = UseOfDiagnose();
  use.command = "predict";
  return use;
}

// Boards and collars need no port, and the camera's place is what is asked for.
CommandUse UseOfHandEye(bool collar) {
  Subjects needs{"cam0", "wrist0"};
  if (collar) needs.insert("tags0");
  return {"calibrate hand-eye", needs, {}, {"cam0.T_RC", "port", "length", "vision0.frame"}};
}

// The body turns about its tip, in the frame of its own sensor.
CommandUse UseOfTip(const std::string& sensor) {
  Subjects needs{sensor};
  if (sensor == "tags0") needs.insert("cam0");
  return {"calibrate tip",
          needs,
          {},
          {"port", "length", "stiffness", "cam0.T_RC", "em0.frame", "vision0.frame"}};
}

CommandUse UseOfEm(const std::string& reference) {
  if (reference == "vision") {
    return {"calibrate em",
            {"em0", "vision0", "cam0.identity"},
            {},
            {"em0.frame", "em0.distance", "port", "length"}};
  }
  return {"calibrate em", With(kShaft, {"em0"}), {}, {"em0.frame", "em0.distance"}};
}

// The gages may read in any unit.
CommandUse UseOfStrain() {
  return {"calibrate strain", With(kShaft, {"strain0", "load0"}), {}, {"strain0"}};
}

CommandUse UseOfStiffness() {
  return {"calibrate stiffness",
          With(kShaft, {"load0", "vision0", "em0", "strain0", "cam0.identity"}),
          {},
          {"stiffness"}};
}

CommandUse UseOfBudget() { return {"calibrate budget", {"cam0", "tags0", "load0"}, {}}; }

}  // namespace flextip
