#include "tests/exchange/tables.h"

#include <fmt/format.h>

#include <cmath>
#include <random>

#include "core/draw_vector.h"
#include "exchange/streams/sensor_settings.h"

namespace flextip::exchange::test_support {

std::vector<PoseRow> KnownMotion() {
  std::mt19937 generator(11);
  std::normal_distribution<double> noise(0.0, 1.0);
  std::vector<PoseRow> rows;
  TimeNs t_ns = 1'700'000'000'123'456'789;
  for (int i = 0; i < 60; ++i) {
    const double t = 0.02 * i;
    PoseRow row;
    row.t_ns = t_ns;
    row.p = Eigen::Vector3d(0.2 + 0.05 * std::sin(3 * t), -0.1 * t, 0.03 * std::cos(2 * t)) +
            1e-4 * DrawVector<3>(noise, generator);
    const double first = noise(generator), last = noise(generator);
    const Eigen::Vector3d w(0.3 * std::sin(t) + 1e-3 * first, 0.5, -0.4 + 1e-3 * last);
    row.q = Eigen::Quaterniond(Eigen::AngleAxisd(w.norm(), w.normalized()));
    rows.push_back(row);
    t_ns += 20'000'000 + static_cast<TimeNs>(std::lround(1e5 * noise(generator)));
  }
  return rows;
}

std::string Digits(double value) { return fmt::format("{:.17g}", value); }

ImportPlan PlanWithSettings() {
  ImportPlan plan;
  plan.length_m = 0.6;
  plan.outer_diameter_m = 0.00238;
  plan.bending_stiffness_Nm2 = 0.304;
  plan.p_RP = Eigen::Vector3d(0.28, 0.0, 0.01);
  TellSensor(plan, "test", "em0", "distance_from_tip_m", "0.02");
  return plan;
}

std::string Refusal(const ImportPlan& plan) {
  try {
    Import(plan);
  } catch (const InputError& error) {
    return error.what();
  }
  return "imported";
}

}  // namespace flextip::exchange::test_support
