// Move, diagnose, plan, move: the simulated robot moves until its recordings tell the causes apart.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "diagnosis/diagnose.h"
#include "diagnosis/planning/plan.h"
#include "simulation/closed_loop/scenario.h"

namespace flextip::simulation {

struct DiagnosingOptions {
  diagnosis::MotionLimits limits;  ///< of each planned motion; for what is left open: LimitsOf
  std::vector<std::string> without;
  int most_rounds = 4;  ///< of motion, the scenario's own included
};

/// One motion and what is known after it.
struct DiagnosingRound {
  std::string name;  ///< of the recording: round_1, round_2, ...
  LoopResult run;
  double seconds = 0.0;       ///< of motion
  double hung_N = 0.0;        ///< weight at the tip beside the scenario's load
  diagnosis::Verdict answer;  ///< of all rounds so far
  double probability = 0.0;   ///< of that answer
  diagnosis::NextMotion next;
};

enum class DiagnosingEnd : std::uint8_t {
  kSeparated,    ///< no cause in the lead has a rival
  kNoMotion,     ///< no motion within the limits tells more
  kRoundsAreUp,  ///< most_rounds were made
};

struct DiagnosingResult {
  std::vector<DiagnosingRound> rounds;  ///< at least one
  DiagnosingEnd end = DiagnosingEnd::kRoundsAreUp;
  diagnosis::DiagnosisResult diagnosis;  ///< of all rounds as one recording

  double Seconds() const;  ///< of motion
};

/// Returns limits for what is left open: the robot's speed, up to a brisk 0.1 m/s, and the depths
/// and angles of the simple motions that a person would make (a third to three quarters of the
/// shaft beyond the port, 25 degrees). The first motion may be too short to say.
diagnosis::MotionLimits LimitsOf(const Scenario& scenario, diagnosis::MotionLimits limits);

/// Returns the scenario of the round after one that ended with the wrist at `p_RW` (m, in R): the
/// tip goes along `motion`, with its weight at the tip. Sensors draw other noise.
Scenario NextScenario(const Scenario& scenario, const diagnosis::NextMotion& motion,
                      const Eigen::Vector3d& p_RW, int round);

/// Runs the first controller of `scenario`, not rendered. The robot is told what the diagnosis of
/// the sensors' recordings says and nothing else. `progress`: what is done now. Throws as
/// RunController and Diagnose do.
DiagnosingResult DiagnoseInLoop(const Scenario& scenario, const DiagnosingOptions& options,
                                const std::function<void(const std::string&)>& progress = {});

}  // namespace flextip::simulation
