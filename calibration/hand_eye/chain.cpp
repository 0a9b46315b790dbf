#include "calibration/hand_eye/chain.h"

#include "core/rotation.h"

namespace flextip {

Pose WristInChain(HandEyeMount mount, const Pose& T_RW) {
  return mount == HandEyeMount::kEyeToHand ? T_RW : T_RW.Inverse();
}

Pose BoardInCamera(HandEyeMount mount, const Pose& T_FC, const Pose& T_KB, const Pose& T_RW) {
  return T_FC.Inverse() * WristInChain(mount, T_RW) * T_KB;
}

namespace {

// d(x_F) for a step of the wrist, x_F the point that is at x_K.
Eigen::Matrix<double, 3, 6> PointPerWristStep(HandEyeMount mount, const Pose& T_RW,
                                              const Eigen::Vector3d& x_K) {
  Eigen::Matrix<double, 3, 6> J;
  if (mount == HandEyeMount::kEyeToHand) {
    J << -Skew(T_RW.R * x_K), Eigen::Matrix3d::Identity();
  } else {
    J << T_RW.R.transpose() * Skew(x_K - T_RW.p), -T_RW.R.transpose();
  }
  return J;
}

}  // namespace

Eigen::Matrix<double, 6, 18> ChainJacobian(HandEyeMount mount, const Pose& T_FC, const Pose& T_KB,
                                           const Pose& T_RW) {
  const Pose T_FK = WristInChain(mount, T_RW);
  const Eigen::Matrix3d R_CF = T_FC.R.transpose(), R_CK = R_CF * T_FK.R;
  const Eigen::Matrix3d turn_by_wrist =
      mount == HandEyeMount::kEyeToHand ? R_CF : Eigen::Matrix3d(-R_CK);
  Eigen::Matrix<double, 6, 18> J = Eigen::Matrix<double, 6, 18>::Zero();
  J.block<3, 3>(0, 0) = -R_CF;
  J.block<3, 3>(3, 0) = R_CF * Skew(T_FK * T_KB.p - T_FC.p);
  J.block<3, 3>(3, 3) = -R_CF;
  J.block<3, 3>(0, 6) = R_CK;
  J.block<3, 3>(3, 9) = R_CK;
  J.block<3, 3>(0, 12) = turn_by_wrist;
  J.block<3, 6>(3, 12) = R_CF * PointPerWristStep(mount, T_RW, T_KB.p);
  return J;
}

std::optional<ChainResiduals> ResidualsOfChain(HandEyeMount mount, const CameraModel& camera,
                                               const std::vector<Correspondence>& points,
                                               const Pose& T_FC, const Pose& T_KB,
                                               const Pose& T_RW) {
  const Pose T_FK = WristInChain(mount, T_RW);
  const Eigen::Matrix3d R_CF = T_FC.R.transpose(), R_CK = R_CF * T_FK.R;
  const CameraCalibration& lens = camera.Calibration();
  const auto rows = static_cast<Eigen::Index>(2 * points.size());
  ChainResiduals all{Eigen::VectorXd(rows), {}, {}};
  all.J.setZero(rows, kShared);
  all.J_wrist.resize(rows, 6);
  for (Eigen::Index i = 0; i < rows; i += 2) {
    const Correspondence& point = points[static_cast<std::size_t>(i / 2)];
    const Eigen::Vector3d turned_K = T_KB.R * point.x_E, x_K = turned_K + T_KB.p;
    const Eigen::Vector3d from_C_F = T_FK * x_K - T_FC.p;
    Eigen::Matrix<double, 2, 3> J_point;
    const auto px = camera.Project(R_CF * from_C_F, &J_point);
    if (!px) return {};
    all.r_px.segment<2>(i) = *px - point.px;
    const Eigen::Matrix<double, 2, 3> J_F = J_point * R_CF, J_K = J_point * R_CK;
    all.J.block<2, 3>(i, 0) = J_F * Skew(from_C_F);
    all.J.block<2, 3>(i, 3) = -J_F;
    all.J.block<2, 3>(i, 6) = -J_K * Skew(turned_K);
    all.J.block<2, 3>(i, 9) = J_K;
    all.J(i, kIntrinsicsColumn) = (px->x() - lens.cu_px) / lens.fu_px;
    all.J(i + 1, kIntrinsicsColumn + 1) = (px->y() - lens.cv_px) / lens.fv_px;
    all.J(i, kIntrinsicsColumn + 2) = all.J(i + 1, kIntrinsicsColumn + 3) = 1.0;
    all.J_wrist.middleRows<2>(i) = J_F * PointPerWristStep(mount, T_RW, x_K);
  }
  return all;
}

}  // namespace flextip
