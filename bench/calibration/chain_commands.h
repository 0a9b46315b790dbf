// The chain by the program's own commands: calibrated, used, and asked for its budget.
#pragma once

#include <Eigen/Dense>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "bench/calibration/chain_scene.h"

namespace flextip::bench {

/// What one repetition came to. Lists have an entry for each frame of the work. V is C turned so
/// that z is the line of sight to the tip.
struct ChainRun {
  /// By part ("pixels", "lens", "hand-eye", "tip offset", "total"), the tip's error in V (m). The
  /// pixels' is with everything else as it truly is; a calibration's is what it adds to that.
  std::map<std::string, std::vector<Eigen::Vector3d>> error_V;
  /// By part, the standard deviations that `calibrate budget` names: along the line of sight, and
  /// in the worst direction across (m).
  std::map<std::string, std::vector<Eigen::Vector2d>> claimed_m;
  std::vector<Eigen::Matrix3d> claimed_V;  ///< the total's covariance (m^2)
};

inline constexpr const char* kChainParts[] = {"pixels", "lens", "hand-eye", "tip offset", "total"};

/// Makes the recordings of one repetition in `folder` and runs `program` on them. Throws WorkError
/// where a command fails or a tip is lost.
ChainRun RunChain(const ChainScene& scene, const std::filesystem::path& program,
                  const std::filesystem::path& folder, unsigned seed);

}  // namespace flextip::bench
