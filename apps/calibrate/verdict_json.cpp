#include "apps/calibrate/verdict_json.h"

#include "apps/common/judgement.h"

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
  nlohmann::json json = JudgementJson(verdict);
  json["values"] = values;
  json["not_found"] = UnobservableJson(verdict.NotFoundByReason());
  return json;
}

}  // namespace flextip
