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
};

/// Gives the series its rate and noises, told or measured; a joint whose name says that it slides
/// (insertion, prismatic, linear) is one. All that is assumed is said. Throws NotTold.
JointStream TakeJoints(JointSeries series, const ImportPlan& plan, ImportLog& log);

StreamLine Describe(const JointStream& joints);

/// Writes sensor.yaml and data.csv into `folder`/joints0 and so on. Throws WorkError.
void WriteJoints(const std::filesystem::path& folder, const JointStream& joints);

}  // namespace flextip::exchange
