#include "reproduction/chapter2/paths/moves.h"

#include <tbb/parallel_for.h>

#include <mutex>

namespace flextip::reproduction {
namespace {

ArmRig Rig(Cause cause) {
  ArmRig rig;
  switch (cause) {
    case kFriction:
      rig.friction_N = kFriction_N;
      break;
    case kFrictionAlone:  // a fifth of every mass, a faster loop and no integral
      rig.friction_N = kFriction_N;
      rig.body = {0.21, 0.21, 0.2 * rig.body.inertia1_kg_m2, 0.2 * rig.body.inertia2_kg_m2,
                  0.2 * rig.body.wrist_mass_kg};
      rig.shaft_mass_kg *= 0.2;
      rig.pid.ki_Nm_rad_s = 0.0;
      rig.rate_hz = 5000.0;
      rig.substeps = 4;
      break;
    case kWeight:
      rig.gravity_m_s2 = 9.81;
      break;
    case kEncoders:
      rig.encoder_rad = 0.03e-3 / 0.21;  // 0.03 mm at the wrist, as its maker states
      break;
    case kLinks:
      rig.link_error = 0.01;
      break;
    case kAccumulated:
    case kAccumulatedFriction:
      rig.joint_goal = JointGoal::kAccumulated;
      rig.gain = 0.001;
      rig.pid = {10.0, 10.0, 0.5};
      rig.friction_N = cause == kAccumulated ? 0.0 : kFriction_N;
      break;
    case kDynamics:
    case kCauses:
      break;
  }
  return rig;
}

TrajectoryMove Move(int index) {
  TrajectoryMove move;
  move.p_start = {kStart_z[index / kGoals], 0.0};
  move.p_goal =
      move.p_start + 0.02 * Eigen::Vector2d(kWay[index % kGoals][0], kWay[index % kGoals][1]);
  return move;
}

MoveResult RunMove(int index, bool quick) {
  MoveResult result;
  result.move = Move(index);
  result.quasi_static = QuasiStaticPath(result.move, 0.01);
  result.away_mm = 1e3 * MovesAway(result.quasi_static, result.move.p_goal);
  const auto run = [&](ArmRig rig) {
    if (quick) rig.longest_s = 3.0;
    Tried tried;
    tried.path = DynamicPath(result.move, rig);
    tried.deviation_mm = 1e3 * LargestDistance(tried.path, result.quasi_static);
    return tried;
  };
  for (int cause = 0; cause < kCauses; ++cause) {
    if (quick && cause > kFriction) break;
    result.by_cause[cause] = run(Rig(static_cast<Cause>(cause)));
  }
  for (std::size_t i = 0; i < kSweep_N.size() && !quick && index >= 2 * kGoals; ++i) {
    ArmRig rig = Rig(kFriction);
    rig.friction_N = kSweep_N[i];
    result.sweep_mm[i] = run(rig).deviation_mm;
  }
  return result;
}

}  // namespace

std::vector<MoveResult> RunMoves(bool quick, const ChapterProgress& progress) {
  std::vector<MoveResult> results(kMoves);
  std::mutex reporting;
  int done = 0;
  tbb::parallel_for(0, kMoves, [&](int i) {
    results[i] = RunMove(i, quick);
    const std::lock_guard lock(reporting);
    progress(static_cast<double>(++done) / kMoves);
  });
  return results;
}

}  // namespace flextip::reproduction
