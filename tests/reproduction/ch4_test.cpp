// Chapter 4's set-up: its plants, noise and controllers against differences and the closed loop.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <string>

#include "reproduction/chapter4/parts.h"
#include "reproduction/chapter4/press.h"
#include "reproduction/printed_jacobian.h"
#include "simulation/closed_loop/scenario.h"

namespace flextip::reproduction {
namespace {

const Eigen::Vector3d kPort(0.28, 0.0, 0.0);

Ch4Plant Hung() {
  simulation::PlantSetup setup;
  setup.instrument = Ch4Rod();
  setup.p_RP = kPort;
  setup.load.constant_N = {0.0, -2.0, 0.0};
  return Ch4Plant::Exact(setup);
}

Ch4Move Move(Ch4Kind kind, int direction) {
  Ch4Move move;
  move.kind = kind;
  move.setup.instrument = Ch4Rod();
  move.setup.p_RP = kPort;
  move.move_m = kCh4Moves[direction];
  return move;
}

/// Half way the printed form is right but for phi: against differences of the beam itself.
TEST(Ch4Printed, IsTheBeamsDerivativeHalfWayWithTheLinesAngle) {
  PlaneBeamProblem problem;
  problem.length_m = 0.6;
  problem.law = BeamLoadLaw::kPortForce;
  problem.load_over_EI = -4.0;
  problem.p_port = {0.28, 0.1};
  PlaneBeam beam = SolvePlaneBeam(problem);
  for (int i = 0; i < 40; ++i) {  // move the wrist until the port is half way
    problem.p_wrist.x() += 0.5 * (beam.a - 0.3);
    beam = SolvePlaneBeam(problem);
  }
  ASSERT_NEAR(beam.a, 0.3, 1e-9);
  Eigen::Matrix2d J;
  for (int i = 0; i < 2; ++i) {
    PlaneBeamProblem plus = problem, minus = problem;
    plus.p_wrist[i] += 1e-6;
    minus.p_wrist[i] -= 1e-6;
    J.col(i) = (SolvePlaneBeam(plus).p_tip - SolvePlaneBeam(minus).p_tip) / 2e-6;
  }
  const Eigen::Vector2d to_port = problem.p_port - problem.p_wrist;
  const double y_a = BeamPortHeight(beam.F_p_over_EI, beam.a, 0.6);
  const double line = std::atan2(to_port.y(), to_port.x());
  EXPECT_LT((PrintedPlaneJacobian(beam.a, y_a, 0.6, line, to_port) - J).norm(), 1e-7);
  EXPECT_GT((PrintedPlaneJacobian(beam.a, y_a, 0.6, beam.phi, to_port) - J).norm(), 0.05);
}

/// The plane's loop against the program's own, which shares neither sensors nor stop logic.
TEST(Ch4Steps, GiveWhatTheClosedLoopGives) {
  const std::string scenarios = std::string(FLEXTIP_SOURCE_DIR) + "/testdata/scenarios/";
  const std::array<const char*, 4> files = {"chapter4_away.yaml", "chapter4_toward.yaml",
                                            "chapter4_up.yaml", "chapter4_down.yaml"};
  for (int direction = 0; direction < 4; ++direction) {
    simulation::Scenario scenario = simulation::ReadScenario(scenarios + files[direction]);
    scenario.loop.controller.kind = ControllerKind::kStraightTrack;
    const simulation::LoopResult loop = simulation::RunClosedLoop(scenario.loop, nullptr);
    const Ch4Run run = RunCh4Move(Move(Ch4Kind::kStraight, direction), Hung());
    EXPECT_NEAR(run.max_m, loop.max_deviation_m, 2e-5) << files[direction];
  }
}

TEST(Ch4Steps, TheRightModelHoldsThePath) {
  const Ch4Plant beam = Ch4Plant::Beam(Ch4Rod(), kPort, -2.0);
  for (int direction = 0; direction < 4; ++direction) {
    EXPECT_LT(RunCh4Move(Move(Ch4Kind::kRod, direction), Hung()).max_m, 2e-5);
    EXPECT_LT(RunCh4Move(Move(Ch4Kind::kTipForce, direction), beam).max_m, 2e-5);
    EXPECT_GT(RunCh4Move(Move(Ch4Kind::kStraight, direction), beam).max_m, 8e-4);
  }
}

TEST(Ch4Steps, NoiseIsAsStatedAndAveragesOut) {
  const Ch4Shape shape = *Hung().At(Eigen::Vector3d::Zero());
  for (const int samples : {1, 25}) {
    const Ch4Noise noise{true, 0.0018, 0.0087, true, samples};
    std::mt19937_64 rng(5);
    double sum2 = 0.0, turn2 = 0.0, largest = 0.0;
    constexpr int kDraws = 4000;
    for (int i = 0; i < kDraws; ++i) {
      const Measurements z = Ch4Sense(shape, noise, rng);
      const double dx = z.em->T_RS.p.x() - shape.p_RE.x();
      sum2 += dx * dx;
      largest = std::max(largest, std::abs(dx));
      const Eigen::Vector3d t = *z.port_direction;
      turn2 += std::pow(std::asin(shape.t_port.cross(t).z()), 2);
    }
    const double four_sigma = 4.0 / std::sqrt(2.0 * kDraws);
    const double sd = 0.0018 / std::sqrt(3.0 * samples);
    EXPECT_NEAR(std::sqrt(sum2 / kDraws) / sd, 1.0, four_sigma);
    EXPECT_NEAR(std::sqrt(turn2 / kDraws) / (0.0087 / std::sqrt(3.0 * samples)), 1.0, four_sigma);
    EXPECT_LE(largest, 0.0018);
    EXPECT_NEAR(Ch4Sense(shape, noise, rng).em->position_noise_m, sd, 1e-12);
  }
}

/// The motors' account: what the block pushes back is its stiffness times the depth.
TEST(Ch4Press, ReachesItsDepthAgainstTheBlock) {
  PressSetup setup;
  setup.position_noise_m = setup.angle_noise_rad = 0.0;
  setup.kind = Ch4Kind::kTipForce;
  const PressRun run = RunPress(setup);
  ASSERT_TRUE(run.finished);
  double deepest = 0.0;
  for (const Eigen::Vector3d& p : run.p_RE) deepest = std::max(deepest, run.p_start.y() - p.y());
  EXPECT_NEAR(deepest, 0.015, 6e-4);
  EXPECT_NEAR(run.peak_force_N, 79.0 * (deepest - 0.5e-3), 0.05);
  EXPECT_LT((run.p_RE.back() - run.p_start).norm(), 1e-3);
  // Without a block to push back the same arm has nothing to wait for.
  setup.tissue_N_m = setup.tissue_tangential_N_m = 0.0;
  const PressRun free = RunPress(setup);
  ASSERT_TRUE(free.finished);
  EXPECT_LT(free.down_s, 0.5 * run.down_s);
  EXPECT_LT(free.peak_force_N, 1e-9);
}

}  // namespace
}  // namespace flextip::reproduction
