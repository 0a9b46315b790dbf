// Wrist motions about a port for recordings: smooth, within reach, of bounded speed.
#pragma once

#include <Eigen/Dense>
#include <cstdint>
#include <functional>
#include <vector>

namespace flextip::hidden {

enum class MotionKind : std::uint8_t {
  kSines,   ///< three incommensurate sines each in depth and both directions
  kRaster,  ///< lines to and fro in one direction, slow advance in the other
  kInOut,   ///< in and out with dwells, the direction changing between
  kCircle,  ///< circles of the direction, the depth swinging
  kSpiral,  ///< circles whose radius grows and shrinks
  kPress,   ///< to one place after the other; there in, hold, out
  kWander,  ///< a smooth random walk
  kStar,    ///< strokes out and back, each in another direction
  kShake,   ///< fast and never twice the same, up to 3 Hz: sessions that clocks are aligned by
};
inline constexpr int kMotionKinds = 9;
const char* Name(MotionKind kind);

/// Tuning never sees the held-out motions.
enum class MotionFamily : std::uint8_t {
  kTuning,   ///< sines, raster, in-out, circle
  kHeldOut,  ///< spiral, press, wander, star
  kAny,      ///< both; kShake is in no family
};
/// The kinds of a family.
std::vector<MotionKind> Kinds(MotionFamily family);

/// Everything in R.
struct MotionSetup {
  MotionKind kind = MotionKind::kSines;
  double length_m = 0.0;                            ///< length of the shaft
  Eigen::Vector3d p_RP = Eigen::Vector3d::Zero();   ///< port
  Eigen::Vector3d axis = Eigen::Vector3d::UnitX();  ///< mean direction of the shaft, unit
  double depth_from = 0.4, depth_to = 0.7;          ///< part of the shaft beyond the port
  double angle_rad = 0.35;                          ///< largest turn from the axis, both ways
  double peak_speed_m_s = 0.12;                     ///< the wrist's highest (0.03 to 0.2)
};

/// One motion: where the wrist is at any time from -1 s on. The wrist lies (1 - depth) L from the
/// port, on the line through it whose direction is turned from the axis by two angles.
class WristCourse {
 public:
  /// Draws what the kind leaves open from `seed`; time is stretched to the peak speed over the
  /// first `duration_s`, or the motion made smaller where its frequencies would leave 0.05 to
  /// 0.6 Hz (kShake: 3 Hz).
  WristCourse(const MotionSetup& setup, std::uint64_t seed, double duration_s);

  Eigen::Vector3d At(double t_s) const;
  /// The straight shaft's direction from wrist to port, unit.
  Eigen::Vector3d Direction(double t_s) const;
  /// A point of the straight shaft, `s_m` from the wrist.
  Eigen::Vector3d StraightPoint(double t_s, double s_m) const;

 private:
  double PeakSpeed(double duration_s) const;

  MotionSetup setup_;
  Eigen::Matrix<double, 3, 2> sideways_;
  /// Depth and the two angles, each in [-1, 1], at a time at the motion's own pace.
  std::function<Eigen::Vector3d(double)> course_;
  double pace_ = 1.0, size_ = 1.0;
};

}  // namespace flextip::hidden
