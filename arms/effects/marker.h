// Whether the place of an outside tracker and of its marker are known.
#pragma once

#include "arms/data/arm_data.h"

namespace flextip::arms {

/// A registration that is no better known than this is not known at all: it is found from the poses
/// before anything is fitted.
inline constexpr double kUnknownRegistration_m = 0.05, kUnknownRegistration_rad = 0.1;

/// The tracker's place in R is found from the poses alone.
inline bool TrackerIsUnknown(const ArmData& data) {
  return data.registration_m > kUnknownRegistration_m ||
         data.registration_rad > kUnknownRegistration_rad;
}

/// The arm's file does not place a marker, and its tracker is not registered: it may be anywhere on
/// the last link. With a registered tracker no marker means the link's own frame.
bool MarkerIsUnknown(const ArmData& data);

}  // namespace flextip::arms
