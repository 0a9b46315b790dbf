// A flexible shaft that an arm holds through a port: the arm's joints say where the wrist is, and
// what is wrong with them stands beside the shaft's own causes in one diagnosis.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "arms/held_shaft/wrist_effects.h"
#include "diagnosis/model/effect.h"

namespace flextip::arms {

/// Returns whether a recording has an arm's encoders (joints0) and a shaft with sensors of its own.
bool HoldsShaft(const Recording& recording);

/// The wrist's frame W is the last link's, or K where the arm's file has T_LK.
class HeldShaft {
 public:
  /// Throws InputError for fewer than 20 rows of joints, and for a wrist0 of another time. `name`
  /// is the recording's in messages.
  HeldShaft(Recording recording, const std::string& name);

  /// The recording, with wrist0 by the joints where it had none. Then it has the orientation where
  /// the last link points at the port and turns with its direction, as one does that the shaft is
  /// fixed to.
  const Recording& WithWrist() const { return recording_; }
  /// What is wrong between encoders and wrist: the arm's effects as effects of the shaft's wrist,
  /// each by itself by the exact kinematics. Of the drags of `joint_backlash` there are none.
  diagnosis::EffectMakers Effects() const { return Effects(arm_); }
  /// The same for a user to whom t = 0 is at `zero_ns`, as to a model of another recording.
  diagnosis::EffectMakers EffectsFrom(TimeNs zero_ns) const;
  /// The names of these.
  std::vector<std::string> Names() const;
  const std::vector<std::string>& Warnings() const { return warnings_; }
  /// The arm by itself: commands against encoders, efforts, outside sensors.
  const ArmData& Data() const { return arm_->data; }

 private:
  static diagnosis::EffectMakers Effects(const std::shared_ptr<const HeldArm>& arm);
  void LeaveOutWithoutJoints(const std::string& name);
  void MakeWrist();
  void CompareWrist();

  Recording recording_;
  std::shared_ptr<const HeldArm> arm_;
  std::vector<std::string> warnings_;
};

}  // namespace flextip::arms
