#include "calibration/verdict/verdict.h"

#include <fmt/format.h>

#include <algorithm>

namespace flextip {

void CalibrationVerdict::MentionCount(std::size_t count, double all, double many,
                                      const std::string& text) {
  if (count > 0) Mention(text, static_cast<double>(count) > many * all);
}

void CalibrationVerdict::AdviseUse(const std::string& where, const std::string& use) {
  if (grade == Grade::kNotFound || !command.empty()) return;
  const std::string give = "give calibration.yaml to " + where;
  if (next.empty()) {
    next = give;
  } else if (grade == Grade::kGood) {
    next = give + "; sharper still: " + next;
  } else {
    next += "; until then " + give;
  }
  command = use;
}

std::string CalibrationVerdict::Judged() const {
  return grade == Grade::kGood ? "Good." : "To be used with care.";
}

std::vector<Calibration::Unobservable> CalibrationVerdict::NotFoundByReason() const {
  std::vector<Calibration::Unobservable> grouped;
  for (const auto& one : not_found) {
    const auto same = std::find_if(grouped.begin(), grouped.end(),
                                   [&](const auto& g) { return g.reason == one.reason; });
    // "cam0.T_RC.p" of "cam0.T_RC.p[0]".
    const std::string name = one.parameter.substr(0, one.parameter.find('['));
    if (same == grouped.end()) {
      grouped.push_back({name, one.reason});
    } else if ((", " + same->parameter + ",").find(" " + name + ",") == std::string::npos) {
      same->parameter += ", " + name;
    }
  }
  return grouped;
}

std::string Counted(std::size_t count, const std::string& noun) {
  return fmt::format("{} {}{}", count, noun, count == 1 ? "" : "s");
}

std::string PlaceText(const Eigen::Vector3d& p_m) {
  return fmt::format("({:.2f}, {:.2f}, {:.2f}) mm", 1e3 * p_m.x(), 1e3 * p_m.y(), 1e3 * p_m.z());
}

}  // namespace flextip
