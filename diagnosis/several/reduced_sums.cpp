#include "diagnosis/several/reduced_sums.h"

#include <numeric>

#include "core/linear_algebra.h"

namespace flextip::diagnosis {
namespace {

/// D (1 + D H D)^-1 D of the unknowns that go, factored.
class Outgoing {
 public:
  Outgoing(const NormalSums& sums, const std::vector<int>& out, const Eigen::VectorXd& sd)
      : sd_(sd), llt_(Matrix(sums, out, sd)) {}

  Eigen::MatrixXd SolveL(const Eigen::MatrixXd& b) const {
    return llt_.SolveL(Eigen::MatrixXd(sd_.asDiagonal() * b));
  }
  Eigen::VectorXd Solve(const Eigen::VectorXd& b) const {
    return sd_.asDiagonal() * Eigen::VectorXd(llt_.Solve(Eigen::VectorXd(sd_.asDiagonal() * b)));
  }
  double LogDeterminant() const { return llt_.LogDeterminant(); }

 private:
  static Eigen::MatrixXd Matrix(const NormalSums& sums, const std::vector<int>& out,
                                const Eigen::VectorXd& sd) {
    Eigen::MatrixXd M = sd.asDiagonal() * Eigen::MatrixXd(sums.H(out, out)) * sd.asDiagonal();
    M.diagonal().array() += 1.0;
    return M;
  }

  const Eigen::VectorXd& sd_;
  Llt<Eigen::Dynamic> llt_;
};

}  // namespace

NormalSums IntegratedOut(const NormalSums& sums, const std::vector<int>& kept,
                         const std::vector<int>& out, const Eigen::VectorXd& sd) {
  NormalSums left(Eigen::Index(kept.size()));
  left.H = sums.H(kept, kept);
  left.g = sums.g(kept);
  left.c = sums.c;
  left.volume = sums.volume;
  left.rows = sums.rows;
  if (out.empty()) return left;
  const Outgoing outgoing(sums, out, sd);
  const Eigen::MatrixXd B = outgoing.SolveL(sums.H(out, kept));
  const Eigen::VectorXd b = outgoing.SolveL(Eigen::MatrixXd(sums.g(out)));
  left.H.noalias() -= B.transpose() * B;
  left.g.noalias() -= B.transpose() * b;
  left.c -= b.squaredNorm();
  left.volume += outgoing.LogDeterminant();
  return left;
}

Eigen::VectorXd BestOf(const NormalSums& sums, const std::vector<int>& kept,
                       const std::vector<int>& out, const Eigen::VectorXd& sd,
                       const Eigen::VectorXd& x) {
  if (out.empty()) return {};
  return Outgoing(sums, out, sd).Solve(sums.g(out) - sums.H(out, kept) * x);
}

NormalSums OfParameters(const LinearProblem& problem, const NormalSums& sums,
                        const Eigen::VectorXd& generic_sd) {
  std::vector<int> parameters(problem.parameters), generic(problem.generic_row.size());
  std::iota(parameters.begin(), parameters.end(), 0);
  std::iota(generic.begin(), generic.end(), problem.parameters);
  return IntegratedOut(sums, parameters, generic, generic_sd);
}

}  // namespace flextip::diagnosis
