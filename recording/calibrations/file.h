// calibration.yaml: the values that a calibration found, their covariance, and the values not
// found.
#pragma once

#include <Eigen/Dense>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "core/camera.h"
#include "core/pose.h"

namespace flextip {

/// The values that a calibration found. Names are places of a recording (docs/formats.md):
/// `cam0.T_RC`, `strain0.gage_matrix`, `instrument.bending_stiffness_Nm2`.
struct Calibration {
  std::string kind;                                    ///< "hand-eye", "tip", "em", ...
  std::map<std::string, Pose> poses;                   ///< by name
  std::map<std::string, std::vector<double>> numbers;  ///< by name, one or more
  std::map<std::string, std::string> texts;            ///< `cam0.distortion_model` and its like

  /// Of all that was found, in the order of CoordinateNames(): a pose counts as (dw, dp), the true
  /// one being (exp([dw]x) R, p + dp). Empty where it is not known.
  Eigen::MatrixXd covariance;

  /// The parameters that the data could not tell.
  struct Unobservable {
    std::string parameter, reason;
  };
  std::vector<Unobservable> unobservable;

  /// Returns `NAME.w[0..2]`, `NAME.p[0..2]` for each pose, then `NAME` or `NAME[i]` for the
  /// numbers; each kind in alphabetical order of the names.
  std::vector<std::string> CoordinateNames() const;
  /// Rows and columns of `covariance` that belong to one entry: the first one's place, and how
  /// many. Throws InputError where there is no such entry.
  struct Range {
    int first = 0, count = 0;
  };
  Range RangeOf(const std::string& name) const;
  /// Returns that entry's block of `covariance`; empty where the covariance is.
  Eigen::MatrixXd CovarianceOf(const std::string& name) const;
};

/// Puts a lens under `camera` ("cam0"): its intrinsics, model and coefficients.
void AddLens(const std::string& camera, const CameraCalibration& lens, Calibration& calibration);

/// Throws InputError with file and line for unknown keys, numbers that are not finite, a covariance
/// of another size, order or sign.
Calibration ReadCalibration(const std::filesystem::path& file);

/// Writes every number exactly. Throws WorkError where the disk refuses, or where there are NaNs.
void WriteCalibration(const std::filesystem::path& file, const Calibration& calibration);

}  // namespace flextip
