#include "apps/calibrate/verdict_json.h"

namespace flextip {

nlohmann::json UnobservableJson(const std::vector<Calibration::Unobservable>& unobservable) {
  nlohmann::json list = nlohmann::json::array();
  for (const auto& u : unobservable) {
    list.push_back({{"parameter", u.parameter}, {"reason", u.reason}});
  }
  return list;
}

nlohmann::json VerdictJson(const CalibrationVerdict& verdict) {
  nlohmann::json values = nlohmann::json::array();
  for (const auto& v : verdict.values) {
    values.push_back({{"name", v.name}, {"value", v.value}, {"sd", v.sd}});
  }
  return {
      {"grade", Name(verdict.grade)}, {"says", verdict.says},
      {"reasons", verdict.reasons},   {"values", values},
      {"next", verdict.next},         {"not_found", UnobservableJson(verdict.NotFoundByReason())},
      {"command", verdict.command}};
}

}  // namespace flextip
