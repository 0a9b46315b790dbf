// The head of a calibration's page: is it good, by how much, what is missing and why, what next.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "recording/calibrations/file.h"

namespace flextip {

enum class CalibrationGrade : std::uint8_t { kGood, kBeware, kNotFound };
/// Returns "good", "beware" or "not found".
const char* Name(CalibrationGrade grade);

/// Texts are in a user's words and stand on the page as they are.
struct CalibrationVerdict {
  struct Value {
    std::string name, value, sd;  ///< with units; `sd` may be empty
  };
  CalibrationGrade grade = CalibrationGrade::kGood;
  std::string says;                                  ///< one sentence
  std::vector<std::string> reasons;                  ///< to be careful, and to know
  std::vector<Value> values;                         ///< found, and how well it fits
  std::vector<Calibration::Unobservable> not_found;  ///< as in calibration.yaml
  std::string next;                                  ///< the next step
  std::string command;                               ///< and as a command to copy; may be empty

  /// Adds a reason to be careful, which takes a good grade down.
  void Beware(const std::string& reason);
  /// Adds `reason` as one to be careful where `careful`, else as one to know.
  void Mention(const std::string& reason, bool careful);
  /// Mentions `text` where `count` is not 0; to be careful above the share `many` of `all`.
  void MentionCount(std::size_t count, double all, double many, const std::string& text);
  void Add(const std::string& name, const std::string& value, const std::string& sd = {}) {
    values.push_back({name, value, sd});
  }
  /// Returns "Good." or "To be used with care.", by the grade.
  std::string Judged() const;
  /// Returns `not_found` with one entry a reason: the parameters' names, without their indices.
  std::vector<Calibration::Unobservable> NotFoundByReason() const;
};

/// Returns "1 view", "3 views".
std::string Counted(std::size_t count, const std::string& noun);
/// Returns "(1.00, 2.00, 3.00) mm" of metres.
std::string PlaceText(const Eigen::Vector3d& p_m);

}  // namespace flextip
