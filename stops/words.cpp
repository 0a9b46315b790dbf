#include "stops/words.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <vector>

namespace flextip {
namespace {

double Degrees(double rad) { return rad * 180.0 / std::numbers::pi; }

std::string List(const std::vector<std::string>& names) {
  std::string text;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (i > 0) text += i + 1 == names.size() ? " and " : ", ";
    text += names[i];
  }
  return text;
}

/// "EM, strain and wrist".
std::string Others(const StopFacts& facts) {
  std::vector<std::string> names;
  for (const VotedSensor sensor : facts.others)
    if (sensor != VotedSensor::kWristTurn) names.emplace_back(SpokenName(sensor));
  names.emplace_back("wrist");
  return List(names);
}

std::string TipOf(VotedSensor sensor) {
  switch (sensor) {
    case VotedSensor::kTip:
      return "the camera's tip";
    case VotedSensor::kEm:
      return "the tip by the EM sensor";
    case VotedSensor::kStrain:
      return "the tip by the strain gages";
    case VotedSensor::kLoad:
      return "the tip by the load cell";
    case VotedSensor::kPortDirection:
      return "the sensor at the port";
    case VotedSensor::kWristTurn:
      return "the wrist's orientation";
  }
  return "";
}

/// What is wrong with the odd sensor.
std::string Oddness(const StopFacts& facts) {
  const bool one = facts.others.empty();
  if (facts.odd_distance_m > 0.0) {
    return fmt::format("{} was {:.1f} mm from where {} {} it", TipOf(*facts.odd),
                       1e3 * facts.odd_distance_m, Others(facts), one ? "puts" : "put");
  }
  return fmt::format("{} contradicted {}", TipOf(*facts.odd), Others(facts));
}

std::string Times(double value, double limit) {
  return limit > 0.0 ? fmt::format("{:.3g} times its limit", value / limit) : "above its limit";
}

std::string OfDisagreement(const StopFacts& facts) {
  if (facts.odd && facts.odd_is_named) return Oddness(facts);
  if (facts.odd) {
    return fmt::format("which sensor was wrong could not be told; most likely {}", Oddness(facts));
  }
  return facts.chi2 > facts.chi2_limit ? "the sensors contradicted each other: chi-squared was " +
                                             Times(facts.chi2, facts.chi2_limit)
                                       : "the sensors contradicted each other";
}

/// Why, in words; empty where the cause says it all.
std::string Why(const StopFacts& facts) {
  const std::string& cause = facts.cause;
  if (cause == "tip_disagrees") return OfDisagreement(facts);
  if (cause == "tip_jump") {
    return facts.jump_m > 0.0
               ? fmt::format("the tip's sensor jumped by {:.1f} mm from one picture to the next",
                             1e3 * facts.jump_m)
               : "the tip's sensor jumped";
  }
  if (cause == "model_disagrees" && facts.chi2 <= facts.chi2_limit)
    return "the tip did not move as the wrist led it";
  if (cause == "model_disagrees") {
    return "no single sensor and no moved port explains it: the shaft is not the model's, "
           "chi-squared was " +
           Times(facts.chi2, facts.chi2_limit);
  }
  if (cause == "port_moved")
    return "the sensors agree with each other only if the port has left its registered place";
  if (cause == "wrist_not_following") {
    return fmt::format("the wrist was {:.1f} mm from where it had been sent",
                       1e3 * facts.wrist_off_m);
  }
  if (cause == "motion_angle") {
    return fmt::format(
        "the tip might have moved {:.0f} degrees beside what was wanted (limit "
        "{:.0f})",
        Degrees(facts.worst_angle_rad), Degrees(facts.worst_angle_limit_rad));
  }
  if (cause == "force") {
    return fmt::format("the tip pressed with {:.2g} N (limit {:.2g})", facts.force_N,
                       facts.force_limit_N);
  }
  if (cause == "stale_tip") return "no new tip came";
  if (cause == "stale_wrist") return "the wrist's readings stood still or were missing";
  if (cause == "source_lost") {
    return facts.detail.empty() ? std::string("a source was gone")
                                : fmt::format("{} was gone", facts.detail);
  }
  if (cause == "bad_time") return "a time stood, ran backwards, or was from the future";
  if (cause == "not_finite") return "a reading or the command was no number";
  if (cause == "tip_astray")
    return "the tip was farther from its way than it may be, and came no nearer";
  if (cause == "port_depth") return "there was too little shaft before or beyond the port";
  if (cause == "deadline") return "several cycles in a row came late";
  if (cause == "no_command") return "the controller had no command";
  return "";
}

std::string Ending(const StopFacts& facts) {
  if (facts.fault_s) {
    return fmt::format("the robot was paused at {:.2f} s{}", *facts.fault_s,
                       facts.open ? " and stayed so" : "");
  }
  if (facts.open) return "it was still held when the recording ended";
  const std::string again = facts.holds > 1 ? fmt::format(" ({} holds in a row)", facts.holds) : "";
  return fmt::format("it went on by itself after {:.2f} s{}", facts.end_s - facts.at_s, again);
}

}  // namespace

const char* SpokenName(VotedSensor sensor) {
  switch (sensor) {
    case VotedSensor::kTip:
      return "camera";
    case VotedSensor::kEm:
      return "EM";
    case VotedSensor::kPortDirection:
      return "port sensor";
    case VotedSensor::kStrain:
      return "strain";
    case VotedSensor::kLoad:
      return "load cell";
    case VotedSensor::kWristTurn:
      return "wrist's turn";
  }
  return "";
}

std::string SayStop(const StopFacts& facts) {
  const std::string why = Why(facts);
  return fmt::format("Held at {:.2f} s by {}{}{}; {}.", facts.at_s, facts.cause,
                     why.empty() ? "" : ": ", why, Ending(facts));
}

}  // namespace flextip
