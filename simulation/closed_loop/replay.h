// The controller of a recorded simulation run again on the recording.
#pragma once

#include <memory>
#include <vector>

#include "recording/frames/frame_source.h"
#include "simulation/closed_loop/scenario.h"

namespace flextip::simulation {

struct ReplayedCommand {
  TimeNs t_ns = 0;
  Eigen::Vector3d p_RW = Eigen::Vector3d::Zero(), p_RW_again = Eigen::Vector3d::Zero();  ///< m, R
  bool equal = false;  ///< bit for bit
};

/// Steps the controller `kind` of `scenario` through a recording of simulate: at each command the
/// newest sample of every stream, and its picture of `frames` where the run was rendered (else
/// null).
/// The path starts where the scenario's plant has the tip. Throws InputError where the recording
/// has no command, or lacks a picture that it names.
std::vector<ReplayedCommand> ReplayController(const Scenario& scenario, ControllerKind kind,
                                              const Recording& recording, FrameSource* frames);

}  // namespace flextip::simulation
