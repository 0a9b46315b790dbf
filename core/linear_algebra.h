// Decompositions of small and dynamic matrices, compiled once. Each class wraps Eigen's of the same
// name. Eigen's own headers would compile the algorithm again in every file that uses it, which
// took most of the build's time. Fixed sizes (see CompiledSize) allocate nothing.
#pragma once

#include <Eigen/Dense>
#include <type_traits>

namespace flextip {

/// The type of a solution: its shape is that of the right-hand sides.
template <int N, class B>
using SolutionOf =
    Eigen::Matrix<double, N == Eigen::Dynamic ? int(B::RowsAtCompileTime) : N, B::ColsAtCompileTime,
                  Eigen::ColMajor, N == Eigen::Dynamic ? int(B::MaxRowsAtCompileTime) : N,
                  B::MaxColsAtCompileTime>;

/// P^T L D L^T P = A for a symmetric A (N x N; its lower triangle is read).
template <int N>
class Ldlt {
 public:
  using Matrix = Eigen::Matrix<double, N, N>;
  using Vector = Eigen::Matrix<double, N, 1>;

  explicit Ldlt(const std::type_identity_t<Matrix>& A);
  template <class A>
  explicit Ldlt(const Eigen::MatrixBase<A>& a) : Ldlt(Matrix(a)) {}

  /// Returns A^-1 B for B of N rows.
  template <class B>
  SolutionOf<N, B> Solve(const Eigen::MatrixBase<B>& b) const {
    SolutionOf<N, B> x = b;
    SolveInPlace(x.data(), x.cols());
    return x;
  }
  /// Returns A^-1.
  Matrix Inverse() const;
  /// Returns D, in the order of the pivots.
  Vector Pivots() const;
  /// Tells whether the decomposition worked and no pivot is negative.
  bool IsPositive() const;
  /// Tells whether the decomposition worked.
  bool Succeeded() const;
  /// Returns an estimate of the reciprocal of A's condition number (1-norm).
  double ReciprocalCondition() const requires(N == 6);

 private:
  void SolveInPlace(double* columns, Eigen::Index count) const;

  Eigen::LDLT<Matrix> ldlt_;
};

/// The decomposition of a matrix of any size, by the processor's wide vectors where it has them.
class LargeLlt {
 public:
  LargeLlt() = default;
  explicit LargeLlt(const Eigen::MatrixXd& A);
  /// Its lower triangle is L.
  const Eigen::MatrixXd& Factor() const { return factor_; }
  Eigen::Index Size() const { return factor_.rows(); }
  bool Succeeded() const { return succeeded_; }

 private:
  Eigen::MatrixXd factor_;
  bool succeeded_ = true;
};

/// L L^T = A for a symmetric, positive definite A (N x N; its lower triangle is read).
template <int N>
class Llt {
 public:
  using Matrix = Eigen::Matrix<double, N, N>;

  Llt() = default;  // of nothing, to be assigned to
  explicit Llt(const std::type_identity_t<Matrix>& A);
  template <class A>
  explicit Llt(const Eigen::MatrixBase<A>& a) : Llt(Matrix(a)) {}

  /// Returns A^-1 B for B of N rows.
  template <class B>
  SolutionOf<N, B> Solve(const Eigen::MatrixBase<B>& b) const {
    SolutionOf<N, B> x = b;
    SolveInPlace(x.data(), x.cols());
    return x;
  }
  /// Returns L^-1 B for B of N rows: rows of covariance A become rows of covariance 1.
  template <class B>
  SolutionOf<N, B> SolveL(const Eigen::MatrixBase<B>& b) const {
    SolutionOf<N, B> x = b;
    SolveLInPlace(x.data(), x.cols());
    return x;
  }
  /// Returns L^-T B for B of N rows.
  template <class B>
  SolutionOf<N, B> SolveLTransposed(const Eigen::MatrixBase<B>& b) const {
    SolutionOf<N, B> x = b;
    SolveLTransposedInPlace(x.data(), x.cols());
    return x;
  }
  /// Returns A^-1.
  Matrix Inverse() const;
  /// Returns the lower triangle L.
  Matrix L() const;
  /// Returns the logarithm of A's determinant.
  double LogDeterminant() const;
  /// Tells whether A was positive definite.
  bool Succeeded() const;
  /// Returns the reciprocal of A's condition number (1-norm).
  double ReciprocalCondition() const requires(N == Eigen::Dynamic);

 private:
  void SolveInPlace(double* columns, Eigen::Index count) const;
  void SolveLInPlace(double* columns, Eigen::Index count) const;
  void SolveLTransposedInPlace(double* columns, Eigen::Index count) const;

  std::conditional_t<N == Eigen::Dynamic, LargeLlt, Eigen::LLT<Matrix>> llt_;
};

/// P^-1 L U = A with partial pivoting, for an invertible A (N x N).
template <int N>
class Lu {
 public:
  using Matrix = Eigen::Matrix<double, N, N>;

  explicit Lu(const std::type_identity_t<Matrix>& A);
  template <class A>
  explicit Lu(const Eigen::MatrixBase<A>& a) : Lu(Matrix(a)) {}

  /// Returns A^-1 B for B of N rows.
  template <class B>
  SolutionOf<N, B> Solve(const Eigen::MatrixBase<B>& b) const {
    SolutionOf<N, B> x = b;
    SolveInPlace(x.data(), x.cols());
    return x;
  }
  /// Returns A^-1.
  Matrix Inverse() const;

 private:
  void SolveInPlace(double* columns, Eigen::Index count) const;

  Eigen::PartialPivLU<Matrix> lu_;
};

/// LU with full pivoting, which tells the rank of A (N x N).
template <int N>
class FullLu {
 public:
  using Matrix = Eigen::Matrix<double, N, N>;
  using Vector = Eigen::Matrix<double, N, 1>;

  explicit FullLu(const std::type_identity_t<Matrix>& A);
  template <class A>
  explicit FullLu(const Eigen::MatrixBase<A>& a) : FullLu(Matrix(a)) {}

  /// Returns a solution x of A x = b, zero along what A does not see.
  Vector Solve(const Vector& b) const;
  bool IsInvertible() const;

 private:
  Eigen::FullPivLU<Matrix> lu_;
};

/// The complete orthogonal decomposition of A (any shape): least squares of least norm.
class CompleteOrthogonal {
 public:
  /// Pivots up to `threshold` times the largest count as zero; 0 takes Eigen's own threshold.
  explicit CompleteOrthogonal(const Eigen::MatrixXd& A, double threshold = 0.0);

  /// Returns the x of least norm among those that minimise |A x - b|.
  Eigen::VectorXd Solve(const Eigen::VectorXd& b) const;
  Eigen::MatrixXd PseudoInverse() const;

 private:
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> qr_;
};

/// A = vectors diag(values) vectors^T for a symmetric A (N x N; its lower triangle is read).
template <int N>
struct SymmetricEigen {
  using Matrix = Eigen::Matrix<double, N, N>;
  using Vector = Eigen::Matrix<double, N, 1>;

  Vector values;   ///< ascending
  Matrix vectors;  ///< unit columns, in the order of the values

  explicit SymmetricEigen(const std::type_identity_t<Matrix>& A);
  template <class A>
  explicit SymmetricEigen(const Eigen::MatrixBase<A>& a) : SymmetricEigen(Matrix(a)) {}

  /// Returns the values alone, ascending.
  static Vector Values(const Matrix& A);
};

/// A = U diag(sigma) V^T for any A (N x N; 2 and 3), by Jacobi rotations.
template <int N>
struct Svd {
  using Matrix = Eigen::Matrix<double, N, N>;
  using Vector = Eigen::Matrix<double, N, 1>;

  Matrix U;
  Vector sigma;  ///< descending
  Matrix V;

  explicit Svd(const std::type_identity_t<Matrix>& A);
  template <class A>
  explicit Svd(const Eigen::MatrixBase<A>& a) : Svd(Matrix(a)) {}

  /// Returns the singular values alone, descending.
  static Vector Values(const Matrix& A);
};

/// Returns the compiled size for so many rows: 2, 3, 6 and `also` have code of their own, all
/// others are dynamic.
constexpr int CompiledSize(int rows, int also = 6) {
  return rows == 2 || rows == 3 || rows == 6 || rows == also ? rows : Eigen::Dynamic;
}

template <class A>
Ldlt(const Eigen::MatrixBase<A>&) -> Ldlt<CompiledSize(A::RowsAtCompileTime, 9)>;
template <class A>
Llt(const Eigen::MatrixBase<A>&) -> Llt<CompiledSize(A::RowsAtCompileTime)>;
template <class A>
Lu(const Eigen::MatrixBase<A>&) -> Lu<CompiledSize(A::RowsAtCompileTime)>;
template <class A>
FullLu(const Eigen::MatrixBase<A>&) -> FullLu<CompiledSize(A::RowsAtCompileTime)>;
template <class A>
SymmetricEigen(const Eigen::MatrixBase<A>&) -> SymmetricEigen<CompiledSize(A::RowsAtCompileTime)>;
template <class A>
Svd(const Eigen::MatrixBase<A>&) -> Svd<A::RowsAtCompileTime>;

/// Returns the eigenvalues of a symmetric matrix, ascending.
template <class A>
auto SymmetricEigenvalues(const Eigen::MatrixBase<A>& a) {
  return SymmetricEigen<CompiledSize(A::RowsAtCompileTime)>::Values(a);
}

/// Returns the singular values of a square matrix, descending.
template <class A>
auto SingularValues(const Eigen::MatrixBase<A>& a) {
  return Svd<A::RowsAtCompileTime>::Values(a);
}

/// Returns e^T C^-1 e, the squared Mahalanobis distance of an error `e` of covariance C.
template <class E, class C>
double MahalanobisSquared(const Eigen::MatrixBase<E>& e, const Eigen::MatrixBase<C>& c) {
  return e.dot(Ldlt(c).Solve(e));
}

/// Returns the x that minimises |A x - b|, by a QR decomposition with column pivoting.
Eigen::VectorXd LeastSquares(const Eigen::MatrixXd& A, const Eigen::VectorXd& b);

}  // namespace flextip
