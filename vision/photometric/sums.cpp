#include "vision/photometric/sums.h"

namespace flextip {

void FaceSums::Finish(const Rows& rows, const Eigen::Vector3d& normal_C,
                      const SpreadByMotion& spread) {
  constexpr int kB = FaceColumns::kBlur, kO = FaceColumns::kOffset, kR = FaceColumns::kResidual;
  constexpr int kBefore = kO, kAfter = kR - kO - 1;  // columns around that of the offset
  static_assert(kBefore + kAfter == Rows::kSize);
  A_.topLeftCorner<kBefore, kBefore>() = rows.A.topLeftCorner<kBefore, kBefore>();
  A_.block<kAfter, kBefore>(kO + 1, 0) = rows.A.bottomLeftCorner<kAfter, kBefore>();
  A_.block<kBefore, kAfter>(0, kO + 1) = rows.A.topRightCorner<kBefore, kAfter>();
  A_.block<kAfter, kAfter>(kO + 1, kO + 1) = rows.A.bottomRightCorner<kAfter, kAfter>();
  scores_.topRows<kBefore>() = rows.scores.topRows<kBefore>();
  scores_.bottomRows<kAfter>() = rows.scores.bottomRows<kAfter>();
  // Outward, against the normal.
  A_.row(kO) = -normal_C.transpose() * A_.middleRows<3>(3);
  A_.col(kO) = -A_.middleCols<3>(3) * normal_C;
  scores_.row(kO) = -normal_C.transpose() * scores_.middleRows<3>(3);
  A_.col(kR).head<kR>() = scores_.rowwise().sum();
  A_.row(kR).head<kR>() = A_.col(kR).head<kR>().transpose();
  A_(kR, kR) = squares_ = rows.squares;
  curvature_ = rows.curvature;
  moments_ = rows.moments;
  const Eigen::Matrix<double, 6, 3> of_pose = spread.topRows<6>();
  const Eigen::RowVector3d of_offset = spread.row(6);
  A_.topRows<6>() += of_pose * A_.middleRows<3>(kB);
  A_.row(kO) += of_offset * A_.middleRows<3>(kB);
  A_.leftCols<6>() += A_.middleCols<3>(kB) * of_pose.transpose();
  A_.col(kO) += A_.middleCols<3>(kB) * of_offset.transpose();
  scores_.topRows<6>() += of_pose * scores_.middleRows<3>(kB);
  scores_.row(kO) += of_offset * scores_.middleRows<3>(kB);
}

double FaceSums::Correlation() const {
  const auto& m = moments_;
  if (m[0] <= 0) return 0.0;
  const double x2 = m[3] - m[1] * m[1] / m[0], y2 = m[4] - m[2] * m[2] / m[0];
  return x2 > 0 && y2 > 0 ? (m[5] - m[1] * m[2] / m[0]) / std::sqrt(x2 * y2) : 0.0;
}

void FaceSums::AddErrorsTo(Histogram& histogram) const {
  for (int i = 0; i < kBins; ++i) histogram[i] += errors_[i];
}

}  // namespace flextip
