// A set-up whose every part is known: a camera, a board and a tag collar on a robot's wrist, and
// the recordings from which the chain is calibrated and then used.
#pragma once

#include <filesystem>
#include <random>
#include <string>
#include <vector>

#include "core/camera.h"
#include "core/tag_collar.h"
#include "core/time_series.h"
#include "simulation/render/laparoscope.h"

namespace flextip::bench {

/// A picture of the collar without noise, and where the collar's frame is in it.
struct ChainView {
  simulation::LinearImage light;
  Pose T_RE;
};

/// The collar's pictures are rendered once, and each repetition puts its own noise on them. Boards
/// are held elsewhere in each: what is wrong with a corner is mostly the same in every picture of
/// one pose, and looks like noise only from pose to pose.
class ChainScene {
 public:
  struct Counts {
    int lens = 12, hand_eye = 12, tip = 30, work = 8;
  };
  explicit ChainScene(const Counts& counts);

  /// Pictures of the board.
  void WriteLens(const std::filesystem::path& folder, std::mt19937& random) const;
  /// Recordings, their camera and collar as they truly are (the collar's tip apart).
  void WriteHandEye(const std::filesystem::path& folder, std::mt19937& random) const;
  void WriteTip(const std::filesystem::path& folder, std::mt19937& random) const;
  void WriteWork(const std::filesystem::path& folder, std::mt19937& random) const;

  /// Where the tip truly is in each frame of the work, in R.
  std::vector<Eigen::Vector3d> Tips() const;
  std::vector<TimeNs> WorkTimes() const;
  const CameraCalibration& camera() const { return camera_; }
  const Eigen::Vector3d& p_E() const { return p_E_; }
  static const char* Board();  ///< as `--board` takes it

 private:
  void DrawCollars();
  void WriteCollar(const std::filesystem::path& folder, const std::vector<ChainView>& views,
                   std::mt19937& random) const;

  Counts counts_;
  CameraCalibration camera_;
  TagCollar collar_;
  Eigen::Vector3d p_E_;  ///< the tip
  std::vector<ChainView> tip_, work_;
};

}  // namespace flextip::bench
