// What is to be said of a stop, found from the moments around it.
#pragma once

#include <Eigen/Dense>
#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "estimation/instrument_model.h"
#include "estimation/shaft_estimator.h"
#include "stops/moment.h"
#include "stops/stop_finder.h"

namespace flextip {

/// In SI units; what is not known is 0, or empty.
struct StopFacts {
  std::string cause;              ///< "tip_disagrees"
  double at_s = 0.0;              ///< the hold's begin, from the run's first cycle
  std::optional<double> fault_s;  ///< when a person had to go on
  double end_s = 0.0;             ///< of the last cycle held
  bool open = false;              ///< the recording ends held
  int holds = 1;                  ///< of the run of holds
  /// The sensor that does not fit the others; `odd_is_named`: the supervisor said so.
  std::optional<VotedSensor> odd;
  bool odd_is_named = false;
  double odd_distance_m = 0.0;      ///< of the tip by it from the tip by the others
  std::vector<VotedSensor> others;  ///< that were there
  double chi2 = 0.0, chi2_limit = 0.0;
  double worst_angle_rad = 0.0, worst_angle_limit_rad = 0.0;
  double force_N = 0.0, force_limit_N = 0.0;
  double wrist_off_m = 0.0;  ///< the measured wrist from the last command
  double jump_m = 0.0;       ///< the tip from the one before
  std::string detail;        ///< a stream's name, where the cause has one
};

/// A moment with the tips that sensors have there; empty where one has none.
struct SeenMoment {
  Moment moment;
  std::array<std::optional<Eigen::Vector3d>, kVotedSensors> p_RE;
  std::optional<Eigen::Vector3d> p_RE_rest;  ///< by all but the odd sensor
  std::uint8_t sensors = 0;                  ///< that were there, as bits
};

struct StopStory {
  StopFacts facts;
  std::vector<SeenMoment> moments;
};

/// The run that the moments are of.
struct StoppedRun {
  TimeNs start_ns = 0;  ///< of the first cycle
  EstimatorOptions estimator;
  double max_motion_angle_rad = 0.0, max_tip_force_N = 0.0;
  /// Makes the found model of the run; empty: none.
  std::function<std::unique_ptr<InstrumentModel>()> model;
};

/// Looks back at a stop: two fits a sensor and moment, 100 moments a second at most.
StopStory TellStop(const StoppedRun& run, const StopEvent& stop,
                   const std::vector<Moment>& moments);

}  // namespace flextip
