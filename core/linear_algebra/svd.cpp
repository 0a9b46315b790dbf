#include "core/linear_algebra.h"

namespace flextip {

template <int N>
Svd<N>::Svd(const std::type_identity_t<Matrix>& A) {
  const Eigen::JacobiSVD<Matrix> svd(A, Eigen::ComputeFullU | Eigen::ComputeFullV);
  U = svd.matrixU();
  sigma = svd.singularValues();
  V = svd.matrixV();
}

template <int N>
auto Svd<N>::Values(const Matrix& A) -> Vector {
  return Eigen::JacobiSVD<Matrix>(A).singularValues();
}

template struct Svd<2>;
template struct Svd<3>;

}  // namespace flextip
