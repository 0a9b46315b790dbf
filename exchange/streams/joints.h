// Joints as joints0, joints_command0 and torque0 of a recording.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/time_series.h"
#include "exchange/describe.h"
#include "exchange/import_plan.h"

namespace flextip::exchange {

/// Angles and ways (rad, m) or torques and forces (Nm, N) of an arm's joints.
struct JointSeries {
  std::string stream;
  std::vector<std::string> names;  ///< of the joints
  std::vector<TimeNs> t_ns;
  std::vector<std::vector<double>> values;  ///< of each time, as many as names
};

/// A series ready to be written.
struct JointStream {
  JointSeries series;
  std::vector<bool> prismatic;
  std::vector<double> noise;
  double rate_hz = 0.0;
  std::string arm_file;  ///< its name in the recording; empty: not told
};

/// The name of the arm's file in the recording: "arm.yaml" or "arm.urdf"; empty where none is told.
std::string ArmFileName(const ImportPlan& plan);

/// Gives the series its rate and noises, told or measured. Which joints slide the arm's file says;
/// without one, a joint whose name says so (insertion, prismatic, linear). All that is assumed is
/// said. Throws NotTold, and InputError where the arm has another number of joints.
JointStream TakeJoints(JointSeries series, const ImportPlan& plan, ImportLog& log);

StreamLine Describe(const JointStream& joints);

/// Writes sensor.yaml and data.csv into `folder`/joints0 and so on. Throws WorkError.
void WriteJoints(const std::filesystem::path& folder, const JointStream& joints);

}  // namespace flextip::exchange
