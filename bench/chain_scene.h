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
#include "simulation/laparoscope.h"

namespace flextip {

/// One picture without noise, and what it shows.
struct ChainView {
  LinearImage light;
  Pose T_RW;  ///< hand-eye: of the wrist that holds the board
  Pose T_RE;  ///< tip and work: of the collar's frame
};

/// Draws every picture once; each repetition puts its own noise on them.
class ChainScene {
 public:
  struct Counts {
    int lens = 12, hand_eye = 12, tip = 30, work = 8;
  };
  explicit ChainScene(const Counts& counts);

  /// Pictures of the board into `folder`.
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
  void DrawBoards(const Counts& counts);
  void DrawCollars(const Counts& counts);
  void WriteCollar(const std::filesystem::path& folder, const std::vector<ChainView>& views,
                   std::mt19937& random) const;

  CameraCalibration camera_;
  TagCollar collar_;
  Eigen::Vector3d p_E_;  ///< the tip
  std::vector<ChainView> lens_, hand_eye_, tip_, work_;
};

}  // namespace flextip
