#include "vision/camera_model.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/linear_algebra.h"

namespace flextip {
namespace {

constexpr double kRightAngleLess_rad = 89.9 * M_PI / 180.0;
constexpr double kTolerance_px = 1e-10;

std::size_t TermsAllowed(const CameraCalibration& c) {
  const std::size_t n = c.distortion_coefficients.size();
  if (c.distortion == Distortion::kOpenCv) {
    if (n != 5 && n != 8 && n != 12) {
      throw InputError(fmt::format(
          "camera: distortion model opencv takes 5, 8 or 12 coefficients, found {}", n));
    }
  } else if (n != 4) {
    throw InputError(fmt::format(
        "camera: distortion model {} takes 4 coefficients, found {}",
        c.distortion == Distortion::kEquidistant ? "equidistant" : "radial-tangential", n));
  }
  return n;
}

void CheckNumbers(const CameraCalibration& c) {
  for (const double v : {c.fu_px, c.fv_px, c.cu_px, c.cv_px}) {
    if (!std::isfinite(v)) throw InputError("camera: an intrinsic parameter is not finite");
  }
  if (c.fu_px <= 0 || c.fv_px <= 0) {
    throw InputError(
        fmt::format("camera: focal lengths must be positive, found {} and {}", c.fu_px, c.fv_px));
  }
  for (const double v : c.distortion_coefficients) {
    if (!std::isfinite(v)) throw InputError("camera: a distortion coefficient is not finite");
  }
}

}  // namespace

CameraModel::CameraModel(const CameraCalibration& calibration) : calibration_(calibration) {
  CheckNumbers(calibration);
  const std::size_t terms = TermsAllowed(calibration);
  for (std::size_t i = 0; i < terms; ++i) {
    k_[static_cast<Eigen::Index>(i)] = calibration.distortion_coefficients[i];
  }
  max_angle_rad_ = FindMaxAngle();
}

// Returns the derivative of the radial part of the distortion: of r f(r) by r = tan(angle), or, for
// the equidistant model, of theta_d by theta.
double CameraModel::RadialDerivative(double r) const {
  const double r2 = r * r;
  if (calibration_.distortion == Distortion::kEquidistant) {
    return 1 + r2 * (3 * k_[0] + r2 * (5 * k_[1] + r2 * (7 * k_[2] + r2 * 9 * k_[3])));
  }
  const double num = 1 + r2 * (k_[0] + r2 * (k_[1] + r2 * k_[4]));
  const double den = 1 + r2 * (k_[5] + r2 * (k_[6] + r2 * k_[7]));
  if (den <= 0) return -1.0;
  const double dnum = 2 * r * (k_[0] + r2 * (2 * k_[1] + r2 * 3 * k_[4]));
  const double dden = 2 * r * (k_[5] + r2 * (2 * k_[6] + r2 * 3 * k_[7]));
  return num / den + r * (dnum * den - num * dden) / (den * den);
}

double CameraModel::FindMaxAngle() const {
  const bool equidistant = calibration_.distortion == Distortion::kEquidistant;
  const auto rises = [&](double angle) {
    return RadialDerivative(equidistant ? angle : std::tan(angle)) > 0.0;
  };
  constexpr int kSteps = 1800;
  double good = 0.0;
  for (int i = 1; i <= kSteps; ++i) {
    double bad = kRightAngleLess_rad * i / kSteps;
    if (rises(bad)) {
      good = bad;
      continue;
    }
    for (int halving = 0; halving < 50; ++halving) {
      const double middle = 0.5 * (good + bad);
      (rises(middle) ? good : bad) = middle;
    }
    break;
  }
  return good;
}

// Distorts by OpenCV's rational model with tangential and thin-prism terms, on the plane z = 1.
Eigen::Vector2d CameraModel::Distort(const Eigen::Vector2d& m, Eigen::Matrix2d* J) const {
  if (calibration_.distortion == Distortion::kEquidistant) return DistortEquidistant(m, J);
  const double x = m.x(), y = m.y(), r2 = m.squaredNorm();
  const double p1 = k_[2], p2 = k_[3];
  const double num = 1 + r2 * (k_[0] + r2 * (k_[1] + r2 * k_[4]));
  const double den = 1 + r2 * (k_[5] + r2 * (k_[6] + r2 * k_[7]));
  const double f = num / den;
  if (J) {
    const double dnum = k_[0] + r2 * (2 * k_[1] + r2 * 3 * k_[4]);
    const double dden = k_[5] + r2 * (2 * k_[6] + r2 * 3 * k_[7]);
    const double df = (dnum - f * dden) / den;                                          // by r2
    const double prism_x = k_[8] + 2 * k_[9] * r2, prism_y = k_[10] + 2 * k_[11] * r2;  // by r2
    (*J)(0, 0) = f + 2 * x * x * df + 2 * p1 * y + 6 * p2 * x + 2 * x * prism_x;
    (*J)(0, 1) = 2 * x * y * df + 2 * p1 * x + 2 * p2 * y + 2 * y * prism_x;
    (*J)(1, 0) = 2 * x * y * df + 2 * p1 * x + 2 * p2 * y + 2 * x * prism_y;
    (*J)(1, 1) = f + 2 * y * y * df + 6 * p1 * y + 2 * p2 * x + 2 * y * prism_y;
  }
  return {x * f + 2 * p1 * x * y + p2 * (r2 + 2 * x * x) + r2 * (k_[8] + k_[9] * r2),
          y * f + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y + r2 * (k_[10] + k_[11] * r2)};
}

// Distorts by Kannala and Brandt: theta_d = theta (1 + k1 theta^2 + k2 theta^4 + k3 theta^6 + k4
// theta^8).
Eigen::Vector2d CameraModel::DistortEquidistant(const Eigen::Vector2d& m,
                                                Eigen::Matrix2d* J) const {
  const double r = m.norm();
  if (r < 1e-6) {  // theta_d / r = 1 + (k1 - 1/3) r^2 + O(r^4)
    const double c = k_[0] - 1.0 / 3.0;
    if (J) {
      *J = (1 + c * r * r) * Eigen::Matrix2d::Identity() + 2 * c * m * m.transpose();
    }
    return m * (1 + c * r * r);
  }
  const double theta = std::atan(r), t2 = theta * theta;
  const double theta_d = theta * (1 + t2 * (k_[0] + t2 * (k_[1] + t2 * (k_[2] + t2 * k_[3]))));
  const double s = theta_d / r;
  if (J) {
    const double ds = (RadialDerivative(theta) / (1 + r * r) - s) / r;
    *J = s * Eigen::Matrix2d::Identity() + (ds / r) * m * m.transpose();
  }
  return m * s;
}

std::optional<Eigen::Vector2d> CameraModel::Project(const Eigen::Vector3d& x_C,
                                                    Eigen::Matrix<double, 2, 3>* J) const {
  if (!(x_C.z() > 0.0)) return {};
  const Eigen::Vector2d m = x_C.head<2>() / x_C.z();
  if (!(std::atan(m.norm()) <= max_angle_rad_)) return {};
  Eigen::Matrix2d J_distort;
  const Eigen::Vector2d d = Distort(m, J ? &J_distort : nullptr);
  const Eigen::Vector2d focal(calibration_.fu_px, calibration_.fv_px);
  if (J) {
    Eigen::Matrix<double, 2, 3> dm;
    dm << 1, 0, -m.x(), 0, 1, -m.y();
    *J = focal.asDiagonal() * J_distort * dm / x_C.z();
  }
  return Eigen::Vector2d(focal.cwiseProduct(d) +
                         Eigen::Vector2d(calibration_.cu_px, calibration_.cv_px));
}

std::optional<Eigen::Vector3d> CameraModel::UnprojectEquidistant(const Eigen::Vector2d& d) const {
  const double target = d.norm();
  const auto theta_d = [&](double t) {
    const double t2 = t * t;
    return t * (1 + t2 * (k_[0] + t2 * (k_[1] + t2 * (k_[2] + t2 * k_[3]))));
  };
  double low = 0.0, high = max_angle_rad_;
  if (target > theta_d(high)) return {};
  if (target < 1e-15) return Eigen::Vector3d(Eigen::Vector3d::UnitZ());
  double t = std::min(target, high);
  for (int i = 0; i < 100; ++i) {  // Newton, kept inside a shrinking bracket
    const double error = theta_d(t) - target;
    (error > 0 ? high : low) = t;
    double next = t - error / RadialDerivative(t);
    if (!(next > low && next < high)) next = 0.5 * (low + high);
    if (std::abs(next - t) < 1e-16) break;
    t = next;
  }
  const Eigen::Vector2d direction = d / target;
  return Eigen::Vector3d(std::sin(t) * direction.x(), std::sin(t) * direction.y(), std::cos(t));
}

std::optional<Eigen::Vector3d> CameraModel::Unproject(const Eigen::Vector2d& px) const {
  const CameraCalibration& c = calibration_;
  if (!px.allFinite()) return {};
  const Eigen::Vector2d d((px.x() - c.cu_px) / c.fu_px, (px.y() - c.cv_px) / c.fv_px);
  if (c.distortion == Distortion::kEquidistant) return UnprojectEquidistant(d);

  const double r_max = std::tan(max_angle_rad_);
  Eigen::Vector2d m = d.norm() < r_max ? d : Eigen::Vector2d(d * (0.9 * r_max / d.norm()));
  Eigen::Matrix2d J;
  Eigen::Vector2d error = Distort(m, &J) - d;
  for (int i = 0; i < 100 && error.norm() > 1e-16; ++i) {  // Newton with halved steps
    const Eigen::Vector2d step = FullLu(J).Solve(error);
    double scale = 1.0;
    Eigen::Vector2d next = m, next_error = error;
    for (; scale > 1e-6; scale *= 0.5) {
      next = m - scale * step;
      if (next.norm() > r_max) continue;
      next_error = Distort(next, &J) - d;
      if (next_error.norm() < error.norm()) break;
    }
    if (scale <= 1e-6) break;
    m = next;
    error = next_error;
  }
  if (error.norm() * std::max(c.fu_px, c.fv_px) > kTolerance_px) return {};
  return Eigen::Vector3d(Eigen::Vector3d(m.x(), m.y(), 1.0).normalized());
}

}  // namespace flextip
