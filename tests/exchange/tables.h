// A known motion, and tables of it as other programs write them.
#pragma once

#include <Eigen/Dense>
#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "core/time_series.h"
#include "exchange/import.h"

namespace flextip::exchange::test_support {

struct PoseRow {
  TimeNs t_ns = 0;
  Eigen::Vector3d p = Eigen::Vector3d::Zero();
  Eigen::Quaterniond q = Eigen::Quaterniond::Identity();
};

/// Sixty poses at about 50 Hz from 2023 on, with every nanosecond and all digits in use.
std::vector<PoseRow> KnownMotion();

/// All 17 digits, with a point.
std::string Digits(double value);

/// A plan with everything that tables do not say: instrument, port, em0's place.
ImportPlan PlanWithSettings();

/// The message of Import's refusal; "imported" where there is none.
std::string Refusal(const ImportPlan& plan);

}  // namespace flextip::exchange::test_support
