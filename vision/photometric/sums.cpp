#include "vision/photometric/sums.h"

namespace flextip {

void FaceSums::Flush() {
  if (filled_ == 0) return;
  const auto used = rows_.leftCols(filled_);
  const Eigen::Matrix<float, FaceColumns::kSize, FaceColumns::kSize> part = used * used.transpose();
  A_ += part.cast<double>();
  filled_ = 0;
}

void FaceSums::Finish(const SpreadByMotion& spread) {
  Flush();
  constexpr int kB = FaceColumns::kBlur, kO = FaceColumns::kOffset;
  const Eigen::Matrix<double, 6, 3> of_pose = spread.topRows<6>();
  const Eigen::RowVector3d of_offset = spread.row(6);
  A_.topRows<6>() += of_pose * A_.middleRows<3>(kB);
  A_.row(kO) += of_offset * A_.middleRows<3>(kB);
  A_.leftCols<6>() += A_.middleCols<3>(kB) * of_pose.transpose();
  A_.col(kO) += A_.middleCols<3>(kB) * of_offset.transpose();
  scores_.topRows<6>() += of_pose.cast<float>() * scores_.middleRows<3>(kB);
  scores_.row(kO) += of_offset.cast<float>() * scores_.middleRows<3>(kB);
}

double FaceSums::Correlation() const {
  const auto& m = moments_;
  if (m[0] <= 0) return 0.0;
  const float x2 = m[3] - m[1] * m[1] / m[0], y2 = m[4] - m[2] * m[2] / m[0];
  return x2 > 0 && y2 > 0 ? (m[5] - m[1] * m[2] / m[0]) / std::sqrt(x2 * y2) : 0.0;
}

void FaceSums::AddErrorsTo(Histogram& histogram) const {
  for (int i = 0; i < kBins; ++i) histogram[i] += errors_[i];
}

}  // namespace flextip
