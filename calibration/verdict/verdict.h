// The head of a calibration's page: is it good, by how much, what is missing and why, what next.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "core/judgement.h"
#include "recording/calibrations/file.h"

namespace flextip {

struct CalibrationVerdict : Judgement {
  struct Value {
    std::string name, value, sd;  ///< with units; `sd` may be empty
  };
  std::vector<Value> values;                         ///< found, and how well it fits
  std::vector<Calibration::Unobservable> not_found;  ///< as in calibration.yaml

  /// Mentions `text` where `count` is not 0; to be careful above the share `many` of `all`.
  void MentionCount(std::size_t count, double all, double many, const std::string& text);
  void Add(const std::string& name, const std::string& value, const std::string& sd = {}) {
    values.push_back({name, value, sd});
  }
  /// Says where the calibration is used, with the command, after what would sharpen it. Nothing
  /// where there is no answer or another command is next.
  void AdviseUse(const std::string& where, const std::string& use);
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
