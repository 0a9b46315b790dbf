// A hard sequence: an instrument with a tag collar moves before the camera, and something hides it.
#pragma once

#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "bench/vision/scene.h"
#include "simulation/render/laparoscope.h"

namespace flextip::bench {

/// What may happen to a tip; "none" among them.
const std::vector<std::string>& VisionEvents();

/// The way of the tip: a shaft through a fixed port, swung and turned along sums of sines; it may
/// leave the picture for a while.
struct TipMotion {
  Pose T_RC;
  Eigen::Vector3d p_CP, p_CE0;  ///< the port, and the tip's middle place
  double roll_rad = 0, roll_swing_rad = 0, roll_hz = 0.3;
  Eigen::Vector3d swing_m, hz, phase;
  Eigen::Vector3d excursion_m = Eigen::Vector3d::Zero();  ///< in C
  simulation::FrameRange excursion{0, -1};
  int ramp_frames = 22;

  Pose TipAt(double t_s) const;  ///< T_RE
};

/// All of one sequence, from its number.
struct VisionSequence {
  static constexpr double kRate_hz = 30.0;

  int number = 0;
  std::vector<std::string> events;               ///< one or two
  std::vector<simulation::FrameRange> in_event;  ///< when
  CameraCalibration camera;                      ///< the tracker's calibration
  TagCollar collar;
  simulation::LaparoscopeOptions options;
  TipMotion motion;
  simulation::FrameRange motion_blur{0, -1};
  double exposure_s = 0;  ///< exposure of the frames in `motion_blur`
  double shaft_radius_m = 1, shaft_diameter_m = 0.005;
  double tag_px = 0, speed_m_s = 0;  ///< side of a tag as drawn; the tip's greatest speed

  bool InEvent(int frame) const;
  simulation::ShaftCurve CurveAt(double t_s) const;
  Image Render(const simulation::Laparoscope& scope, int frame) const;
};

/// The same arguments give the same sequence. `families`: one is drawn.
VisionSequence DrawSequence(std::uint64_t seed, int number, int frames, int width_px,
                            const std::vector<std::string>& families,
                            const std::vector<std::string>& events);

/// Random numbers of a draw.
class Draw {
 public:
  Draw(std::uint64_t seed, std::uint64_t number) {
    std::seed_seq sequence{seed, number};
    random_.seed(sequence);
  }
  double Between(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }
  int Whole(int low, int high) { return std::uniform_int_distribution<int>(low, high)(random_); }
  bool Chance(double p) { return Between(0, 1) < p; }
  double Sign() { return Chance(0.5) ? 1.0 : -1.0; }
  template <class T>
  const T& OneOf(const std::vector<T>& values) {
    return values[static_cast<std::size_t>(Whole(0, static_cast<int>(values.size()) - 1))];
  }

 private:
  std::mt19937_64 random_;
};

/// Adds what the event needs to `sequence`, in the frames given (vision_events.cpp).
void AddEvent(const std::string& event, simulation::FrameRange frames, Draw& draw,
              VisionSequence& sequence);

}  // namespace flextip::bench
