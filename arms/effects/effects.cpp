#include "arms/effects/effects.h"

namespace flextip::arms {

Effects MakeEffects(const Arm& arm) {
  Effects effects;
  effects.push_back(MakeJointOffset());
  effects.push_back(MakeJointScale());
  effects.push_back(MakeJointCoupling());
  effects.push_back(MakeJointBacklash());
  effects.push_back(MakeCommandLatency());
  effects.push_back(MakeServoDroop());
  effects.push_back(MakeServoLag());
  effects.push_back(MakeJointCompliance());
  effects.push_back(MakeJointFriction());
  effects.push_back(MakeLinkGeometry());
  for (int place = 0; place < int(arm.payload_places.size()); ++place)
    effects.push_back(MakePayload(arm, place));
  effects.push_back(MakeToolOffset());
  effects.push_back(MakeTrackerRegistration());
  effects.push_back(MakeTorqueDrift());
  return effects;
}

Effects MakeNuisances() {
  Effects nuisances;
  nuisances.push_back(MakeTrackerPlace());
  nuisances.push_back(MakeMarkerPlace());
  nuisances.push_back(MakeMasses());
  nuisances.push_back(MakeEffortShape());
  nuisances.push_back(MakeServoInertia());
  nuisances.push_back(MakePlayStart());
  nuisances.push_back(MakePlaySpring());
  return nuisances;
}

}  // namespace flextip::arms
