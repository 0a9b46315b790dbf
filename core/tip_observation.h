// A tip sensor's reading at an instant: made by vision, kept by recordings, used by control.
#pragma once

#include <Eigen/Dense>
#include <optional>

namespace flextip {

enum class TipStatus {
  kOk,         ///< measured in this frame
  kPredicted,  ///< carried on from earlier frames
  kLost,       ///< not known: position and covariance mean nothing
};

/// Returns the name as in recordings and summaries.
inline const char* Name(TipStatus status) {
  switch (status) {
    case TipStatus::kOk:
      return "ok";
    case TipStatus::kPredicted:
      return "predicted";
    case TipStatus::kLost:
      return "lost";
  }
  return "";
}

struct TipObservation {
  TipStatus status = TipStatus::kLost;
  Eigen::Vector3d p_RE = Eigen::Vector3d::Zero();           ///< m
  Eigen::Matrix3d covariance_m2 = Eigen::Matrix3d::Zero();  ///< of p_RE, in R
  std::optional<Eigen::Vector3d> d_RE;                      ///< the shaft's direction at E, unit
};

}  // namespace flextip
