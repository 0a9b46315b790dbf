#include "calibration/camera/corner_error.h"

#include <ceres/cost_function.h>
#include <ceres/rotation.h>

#include <cmath>

#include "calibration/camera/lens_derivative.h"
#include "core/rotation.h"

namespace flextip {
namespace {

// Where a corner lands farther off the lens function has run away.
constexpr double kFarthest_px = 1e6;

class CornerError : public ceres::CostFunction {
 public:
  CornerError(const CameraSolution& s, const SolvedView& view, std::size_t i, bool by_place)
      : distortion_(s.camera.distortion),
        terms_(s.IntrinsicsCount() - 4),
        x_B_(view.x_B[i]),
        offset_B_(s.shape.Of(view.ids[i])),
        shape_(s.warp.Shape(x_B_)),
        px_(view.px[i]),
        R_(view.T_CB.R),
        p_(view.T_CB.p) {
    set_num_residuals(2);
    *mutable_parameter_block_sizes() = {4 + terms_, kWarpSize, kPoseSize};
    if (by_place) mutable_parameter_block_sizes()->push_back(kCornerSize);
  }

  bool Evaluate(double const* const* at, double* error, double** jacobians) const override {
    const double *c = at[0], *step = at[2];
    const bool by_place = parameter_block_sizes().size() > 3;
    Eigen::Vector3d place_B = x_B_;
    if (by_place) {
      place_B += Eigen::Map<const Eigen::Vector3d>(at[3]);
    } else {
      place_B += offset_B_;
    }
    place_B.z() += shape_.x() * at[1][0] + shape_.y() * at[1][1];
    const Eigen::Vector3d turned = R_ * place_B;
    Eigen::Matrix3d dx_dw;
    const Eigen::Vector3d x_C =
        Turn(step, turned, dx_dw) + p_ + Eigen::Map<const Eigen::Vector3d>(step + 3);
    if (!(x_C.z() > 0.0)) return false;
    const Eigen::Vector2d m = x_C.head<2>() / x_C.z();
    const LensDerivative lens = DifferentiateLens(distortion_, c + 4, terms_, m);
    const Eigen::Vector2d& d = lens.d;
    error[0] = c[0] * d.x() + c[2] - px_.x();
    error[1] = c[1] * d.y() + c[3] - px_.y();
    if (!(std::abs(error[0]) + std::abs(error[1]) < kFarthest_px)) return false;
    if (!jacobians) return true;

    const Eigen::Vector2d focal_px(c[0], c[1]);
    if (jacobians[0]) {
      Eigen::Map<Eigen::Matrix<double, 2, Eigen::Dynamic, Eigen::RowMajor>> J(jacobians[0], 2,
                                                                              4 + terms_);
      J.leftCols<4>() << d.x(), 0, 1, 0, 0, d.y(), 0, 1;
      for (int t = 0; t < terms_; ++t) {
        J.col(4 + t) = focal_px.cwiseProduct(lens.by_k.col(t));
      }
    }
    Eigen::Matrix<double, 2, 3> dm_dx;
    dm_dx << 1, 0, -m.x(), 0, 1, -m.y();
    const Eigen::Matrix<double, 2, 3> J_x = focal_px.asDiagonal() * lens.by_m * dm_dx / x_C.z();
    if (jacobians[1]) {
      Eigen::Vector3d normal;
      const Eigen::Vector3d out = R_.col(2);
      ceres::AngleAxisRotatePoint(step, out.data(), normal.data());
      Eigen::Map<RowMajor<kWarpSize>> J(jacobians[1]);
      J = (J_x * normal) * shape_.transpose();
    }
    if (jacobians[2]) {
      Eigen::Map<RowMajor<kPoseSize>> J(jacobians[2]);
      J << J_x * dx_dw, J_x;
    }
    if (by_place && jacobians[3]) {
      Eigen::Matrix3d turn;  // of the step
      ceres::AngleAxisToRotationMatrix(step, turn.data());
      Eigen::Map<RowMajor<kCornerSize>> J(jacobians[3]);
      J = J_x * turn * R_;
    }
    return true;
  }

 private:
  template <int kColumns>
  using RowMajor = Eigen::Matrix<double, 2, kColumns, Eigen::RowMajor>;

  // exp([w]x) x with its derivative, -[exp([w]x) x]x times SO(3)'s left Jacobian.
  static Eigen::Vector3d Turn(const double* step, const Eigen::Vector3d& x, Eigen::Matrix3d& by_w) {
    const Eigen::Vector3d w(step[0], step[1], step[2]);
    Eigen::Vector3d turned;
    ceres::AngleAxisRotatePoint(step, x.data(), turned.data());
    const double angle2 = w.squaredNorm(), angle = std::sqrt(angle2);
    const bool small = angle < 1e-4;
    const double a = small ? 0.5 - angle2 / 24 : (1 - std::cos(angle)) / angle2;
    const double b = small ? 1.0 / 6 - angle2 / 120 : (angle - std::sin(angle)) / (angle * angle2);
    const Eigen::Matrix3d W = Skew(w);
    by_w = -Skew(turned) * (Eigen::Matrix3d::Identity() + a * W + b * W * W);
    return turned;
  }

  Distortion distortion_;
  int terms_;
  Eigen::Vector3d x_B_;         // of the flat board
  Eigen::Vector3d offset_B_;    // where it is held
  Eigen::Vector2d shape_, px_;  // BoardWarp::Shape
  Eigen::Matrix3d R_;           // where the pose step starts
  Eigen::Vector3d p_;
};

}  // namespace

std::unique_ptr<ceres::CostFunction> MakeCornerError(const CameraSolution& s,
                                                     const SolvedView& view, std::size_t i,
                                                     bool by_place) {
  return std::make_unique<CornerError>(s, view, i, by_place);
}

}  // namespace flextip
