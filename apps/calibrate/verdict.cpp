#include "apps/calibrate/verdict.h"

#include <fmt/format.h>

#include <algorithm>

namespace flextip {
namespace {

const char* Name(CalibrationGrade grade) {
  switch (grade) {
    case CalibrationGrade::kGood:
      return "good";
    case CalibrationGrade::kBeware:
      return "beware";
    case CalibrationGrade::kNotFound:
      break;
  }
  return "not found";
}

// "cam0.T_RC.p[0]" of "cam0.T_RC.p[0..2]" and so on: the name without its index.
std::string WithoutIndex(const std::string& parameter) {
  return parameter.substr(0, parameter.find('['));
}

nlohmann::json ByReason(const std::vector<Calibration::Unobservable>& not_found) {
  std::vector<Calibration::Unobservable> grouped;
  for (const auto& one : not_found) {
    const auto same = std::find_if(grouped.begin(), grouped.end(),
                                   [&](const auto& g) { return g.reason == one.reason; });
    const std::string name = WithoutIndex(one.parameter);
    if (same == grouped.end()) {
      grouped.push_back({name, one.reason});
    } else if ((", " + same->parameter + ",").find(" " + name + ",") == std::string::npos) {
      same->parameter += ", " + name;
    }
  }
  nlohmann::json list = nlohmann::json::array();
  for (const auto& g : grouped) list.push_back({{"parameter", g.parameter}, {"reason", g.reason}});
  return list;
}

}  // namespace

void CalibrationVerdict::Beware(const std::string& reason) {
  if (grade == CalibrationGrade::kGood) grade = CalibrationGrade::kBeware;
  reasons.push_back(reason);
}

nlohmann::json VerdictJson(const CalibrationVerdict& verdict) {
  nlohmann::json values = nlohmann::json::array();
  for (const auto& v : verdict.values) {
    values.push_back({{"name", v.name}, {"value", v.value}, {"sd", v.sd}});
  }
  return {{"grade", Name(verdict.grade)}, {"says", verdict.says},
          {"reasons", verdict.reasons},   {"values", values},
          {"next", verdict.next},         {"not_found", ByReason(verdict.not_found)}};
}

std::string Counted(std::size_t count, const std::string& what) {
  return fmt::format("{} {}{}", count, what, count == 1 ? "" : "s");
}

std::string PlaceText(const Eigen::Vector3d& p_m) {
  return fmt::format("({:.2f}, {:.2f}, {:.2f}) mm", 1e3 * p_m.x(), 1e3 * p_m.y(), 1e3 * p_m.z());
}

}  // namespace flextip
