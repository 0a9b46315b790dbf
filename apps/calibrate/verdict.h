// The head of a calibration's page: is it good, by how much, what is missing and why, what next.
#pragma once

#include <Eigen/Dense>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "recording/calibrations/file.h"

namespace flextip {

enum class CalibrationGrade : std::uint8_t { kGood, kBeware, kNotFound };

/// Texts are in a user's words and stand on the page as they are.
struct CalibrationVerdict {
  struct Value {
    std::string name, value, sd;  ///< with units; `sd` may be empty
  };
  CalibrationGrade grade = CalibrationGrade::kGood;
  std::string says;                                  ///< one sentence
  std::vector<std::string> reasons;                  ///< what is wrong, the worst first
  std::vector<Value> values;                         ///< what was found and how well it fits
  std::vector<Calibration::Unobservable> not_found;  ///< those of one reason become one
  std::string next;                                  ///< what to do next

  /// A reason to be careful.
  void Beware(const std::string& reason);
  void Add(const std::string& name, const std::string& value, const std::string& sd = {}) {
    values.push_back({name, value, sd});
  }
};

/// For `verdict` in summary.json (docs/formats.md).
nlohmann::json VerdictJson(const CalibrationVerdict& verdict);

/// "1 view", "3 views".
std::string Counted(std::size_t count, const std::string& what);
/// "(1.00, 2.00, 3.00) mm" of metres.
std::string PlaceText(const Eigen::Vector3d& p_m);

}  // namespace flextip
