// A bent tube with a round section, in the camera's frame: a circle swept along a smooth curve.
#pragma once

#include <Eigen/Dense>
#include <vector>

namespace flextip::simulation::render {

/// The surface at distance `radius` from a smooth curve through given points, ending in half
/// spheres that lie within the curve's length (so the last point is on the surface).
class Tube {
 public:
  struct Ends {
    bool first_round = false, last_round = true;  ///< an end that is not round is open
  };
  /// `points` (m, at least two, each apart from the next); `last_tangent`: the direction at the
  /// last point, zero where it is to come from the points.
  Tube(const std::vector<Eigen::Vector3d>& points, const Eigen::Vector3d& last_tangent,
       double radius_m, Ends ends);

  struct Hit {
    double depth = 0;        ///< x = depth * ray
    Eigen::Vector3d normal;  ///< unit, outward
  };
  /// The first meeting with the ray through the camera's centre. `s_m`, the place on the curve,
  /// is a guess on entry (right to a few diameters) and the place met, or passed, on return.
  bool Intersect(const Eigen::Vector3d& ray, double& s_m, Hit& hit) const;

  /// The curve and its tangent at the arc length `s_m`, extended straight beyond its ends.
  void Curve(double s_m, Eigen::Vector3d& point, Eigen::Vector3d& tangent) const;
  double LengthM() const { return step_m_ * static_cast<double>(points_.size() - 1); }
  double RadiusM() const { return radius_m_; }
  double StepM() const { return step_m_; }

 private:
  bool IntersectEnd(const Eigen::Vector3d& ray, double s_end_m, Hit& hit) const;

  std::vector<Eigen::Vector3d> points_, tangents_;  // at equal steps of arc length
  double step_m_ = 0, radius_m_ = 0;
  Ends ends_;
};

}  // namespace flextip::simulation::render
