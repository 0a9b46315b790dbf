#include "apps/diagnose/motion_options.h"

namespace flextip {

diagnosis::MotionLimits MotionOptions::Within() const {
  diagnosis::MotionLimits within = limits;
  if (inserted_m.size() == 2) {
    within.inserted_from_m = inserted_m[0];
    within.inserted_to_m = inserted_m[1];
  }
  within.may_hang_weight = !no_weight;
  return within;
}

std::optional<diagnosis::MotionLimits> MotionOptions::Limits() const {
  if (!plan) return {};
  return Within();
}

void AddMotionOptions(CLI::App& command, MotionOptions& options) {
  auto* plan = command.add_flag("--plan-motion", options.plan,
                                "Write OUT/motion.yaml: the path of the tip that tells the leading "
                                "causes apart soonest. Limits not given are the recording's own");
  AddMotionLimits(command, options, plan);
}

void AddMotionLimits(CLI::App& command, MotionOptions& options, CLI::Option* plan) {
  constexpr double kAnHour = 3600.0, kHalfTurn = 1.5;
  const auto limit = [&](const char* name, auto& value, const char* text, const char* unit) {
    return command.add_option(name, value, text)->type_name(unit)->needs(plan);
  };
  limit("--plan-seconds", options.limits.seconds, "The longest motion (20)", "S")
      ->check(CLI::Range(1.0, kAnHour));
  limit("--plan-speed", options.limits.wrist_speed_m_s, "The wrist's highest speed", "M/S")
      ->check(CLI::PositiveNumber);
  limit("--plan-force", options.limits.port_force_N, "The port's highest force across the shaft",
        "N")
      ->check(CLI::PositiveNumber);
  limit("--plan-depth", options.inserted_m, "Depth of the tip beyond the port, least and most",
        "M,M")
      ->delimiter(',')
      ->expected(2);
  limit("--plan-angle", options.limits.angle_rad,
        "The shaft's largest angle from its mean direction", "RAD")
      ->check(CLI::Range(0.01, kHalfTurn));
  command.add_flag("--plan-no-weight", options.no_weight, "Hang no weight from the tip")
      ->needs(plan);
}

}  // namespace flextip
