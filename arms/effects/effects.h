// Makers of all effects of arms, one file each, and the list of those that a recording could show.
#pragma once

#include <memory>
#include <string>

#include "arms/effects/effect.h"

namespace flextip::arms {

std::unique_ptr<ArmEffect> MakeJointOffset();
std::unique_ptr<ArmEffect> MakeJointScale();
std::unique_ptr<ArmEffect> MakeJointCoupling();
std::unique_ptr<ArmEffect> MakeJointBacklash();
std::unique_ptr<ArmEffect> MakeJointCompliance();
std::unique_ptr<ArmEffect> MakeCommandLatency();
std::unique_ptr<ArmEffect> MakeServoLag();
std::unique_ptr<ArmEffect> MakeServoDroop();
std::unique_ptr<ArmEffect> MakeJointFriction();
std::unique_ptr<ArmEffect> MakeLinkGeometry();
std::unique_ptr<ArmEffect> MakeToolOffset();
std::unique_ptr<ArmEffect> MakeTrackerRegistration();
std::unique_ptr<ArmEffect> MakeTorqueDrift();
/// At the arm's place of that index.
std::unique_ptr<ArmEffect> MakePayload(const Arm& arm, int place);

/// Nuisances: the tracker's and the marker's place where they are unknown, all that efforts and
/// servos need that no file states, where plays stand when a recording begins, and what pulls at
/// joints that drag each other.
std::unique_ptr<ArmEffect> MakeTrackerPlace();
std::unique_ptr<ArmEffect> MakeMarkerPlace();
std::unique_ptr<ArmEffect> MakeMasses();
std::unique_ptr<ArmEffect> MakeEffortShape();
std::unique_ptr<ArmEffect> MakeServoInertia();
std::unique_ptr<ArmEffect> MakePlayStart();
std::unique_ptr<ArmEffect> MakePlaySpring();

/// Returns how plays are replayed by what joint_backlash reported: through windows, else through
/// widths, with what they carry. Throws InputError where a list has another length.
PlayHistory PlayHistoryOf(const std::vector<ArmParameter>& backlash, int joints);

/// Effects of the catalogue, payloads at each place of `arm`.
Effects MakeEffects(const Arm& arm);
Effects MakeNuisances();

}  // namespace flextip::arms
