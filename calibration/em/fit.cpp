#include "calibration/em/fit.h"

#include <algorithm>
#include <cmath>

#include "calibration/residual_statistics.h"
#include "core/linear_algebra.h"
#include "core/median.h"
#include "core/rotation.h"

namespace flextip {
namespace {

/// Rows: what the gauge holds to zero, times the coefficients (three of each f_k in turn).
Eigen::MatrixXd GaugeOf(const EmDesign& design) {
  const int n = design.Coefficients();
  Eigen::MatrixXd G = Eigen::MatrixXd::Zero(design.basis.kind == FieldKind::kSpline ? 6 : 3, n);
  if (design.basis.kind == FieldKind::kPolynomial) {
    int row = 0;
    for (int i = 0; i < 3; ++i) {
      for (int j = i + 1; j < 3; ++j, ++row) {
        G(row, 3 * j + i) = 1.0 / design.scale_m[j];
        G(row, 3 * i + j) = -1.0 / design.scale_m[i];
      }
    }
    return G;
  }
  const int side = design.basis.order;
  for (int k = 0; k < design.basis.Count(); ++k) {
    const int x = k / (side * side), y = k / side % side, z = k % side;
    const Eigen::Vector3d place(x, y, z);
    const Eigen::Vector3d u = 2.0 / (side - 3) * (place.array() - 1.0) - 1.0;
    G.block<3, 3>(0, 3 * k).setIdentity();
    G.block<3, 3>(3, 3 * k) = Skew(u.cwiseProduct(design.scale_m / design.scale_m.maxCoeff()));
  }
  return G;
}

/// Information of "second differences along every side are zero".
Eigen::MatrixXd BendInformation(const EmDesign& design) {
  const int n = design.basis.order, count = design.Coefficients();
  Eigen::MatrixXd P = Eigen::MatrixXd::Zero(count, count);
  const int stride[3] = {n * n, n, 1};
  for (int k = 0; k < design.basis.Count(); ++k) {
    const int place[3] = {k / (n * n), k / n % n, k % n};
    for (int axis = 0; axis < 3; ++axis) {
      if (place[axis] == 0 || place[axis] == n - 1) continue;
      const int at[3] = {k - stride[axis], k, k + stride[axis]};
      const double factor[3] = {1.0, -2.0, 1.0};
      for (int a = 0; a < 3; ++a) {
        for (int b = 0; b < 3; ++b) {
          P.block<3, 3>(3 * at[a], 3 * at[b]).diagonal().array() += factor[a] * factor[b];
        }
      }
    }
  }
  return P / (design.bend_sd_m * design.bend_sd_m);
}

/// What is known of the coefficients beforehand: the gauge, in which the pairs tell nothing, so
/// that its weight matters little, and a spline's bend.
Eigen::MatrixXd HeldInformation(const EmDesign& design, double typical) {
  constexpr double kGaugeWeight = 1e4;
  const Eigen::MatrixXd G = GaugeOf(design).rowwise().normalized();
  Eigen::MatrixXd held = kGaugeWeight * typical * G.transpose() * G;
  if (design.bend_sd_m > 0) held += BendInformation(design);
  return held;
}

EmSolution Moved(const EmSolution& from, const EmDesign& design, const Eigen::VectorXd& step) {
  EmSolution to = from;
  to.T_RF.R = ExpRotation(step.head<3>()) * from.T_RF.R;
  to.T_RF.p += step.segment<3>(3);
  if (design.free_distance) to.distance_m += step[6];
  const int n = design.Coefficients();
  for (int i = 0; i < n; ++i) to.field.coefficients[i] += step[step.size() - n + i];
  return to;
}

EmSolution StartOf(const EmSolution& start, const EmDesign& design) {
  EmSolution solution{.T_RF = start.T_RF, .distance_m = start.distance_m};
  solution.field = {std::vector<double>(design.Coefficients(), 0.0), design.centre_m,
                    design.scale_m};
  return solution;
}

/// Without noise of its own: the turn and shift that fit best (Umeyama 1991).
Pose ClosedForm(const std::vector<EmPair>& pairs, double distance_m) {
  Eigen::Matrix3Xd from(3, pairs.size()), to(3, pairs.size());
  Eigen::Index i = 0;
  for (const EmPair& pair : pairs) {
    from.col(i) = pair.T_FS.p;
    to.col(i++) = pair.p_RE - distance_m * pair.t_RE;
  }
  return Pose::FromMatrix(Eigen::umeyama(from, to, false));
}

}  // namespace

Eigen::Vector3d EmError(const EmPair& pair, const EmSolution& solution) {
  return ApplyField(solution.field, solution.T_RF * pair.T_FS.p) -
         (pair.p_RE - solution.distance_m * pair.t_RE);
}

double EmSigmas(const EmPair& pair, const EmSolution& solution) {
  const Eigen::Vector3d r = EmError(pair, solution);
  return std::sqrt(r.dot(Llt(pair.covariance).Solve(r)));
}

EmRows RowsOf(const std::vector<EmPair>& pairs, const EmDesign& design,
              const EmSolution& solution) {
  const int fixed = design.Parameters() - design.Coefficients();
  EmRows rows;
  rows.J.setZero(3 * static_cast<Eigen::Index>(pairs.size()), design.Parameters());
  rows.r.resize(rows.J.rows());
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const EmPair& pair = pairs[i];
    auto J = rows.J.middleRows<3>(3 * static_cast<Eigen::Index>(i));
    const Eigen::Vector3d turned = solution.T_RF.R * pair.T_FS.p;
    const Eigen::Matrix3d L = Llt(pair.covariance).L();
    const Eigen::Matrix3d W = L.inverse();
    J.leftCols<3>() = -W * Skew(turned);
    J.middleCols<3>(3) = W;
    if (design.free_distance) J.col(6) = W * pair.t_RE;
    rows.r.segment<3>(3 * static_cast<Eigen::Index>(i)) = W * EmError(pair, solution);
    if (design.basis.kind == FieldKind::kNone) continue;
    const Eigen::Vector3d u = (turned + solution.T_RF.p - design.centre_m)
                                  .cwiseQuotient(design.scale_m)
                                  .cwiseMax(-1.0)
                                  .cwiseMin(1.0);
    const Eigen::VectorXd f = design.basis.At(u);
    for (Eigen::Index k = 0; k < f.size(); ++k) {
      if (f[k] != 0.0) J.middleCols<3>(fixed + 3 * k) = f[k] * W;
    }
  }
  return rows;
}

EmStep SolveStep(const EmDesign& design, const Eigen::MatrixXd& H, const Eigen::VectorXd& g,
                 const Eigen::VectorXd& coefficients, bool with_covariance) {
  const int n = design.Coefficients();
  Eigen::MatrixXd information = H;
  Eigen::VectorXd gradient = g;
  if (n > 0) {
    const Eigen::MatrixXd held = HeldInformation(design, H.diagonal().tail(n).mean());
    information.bottomRightCorner(n, n) += held;
    gradient.tail(n) += held * coefficients;
  }
  const Eigen::VectorXd scale = information.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const Llt llt(scale.asDiagonal() * information * scale.asDiagonal());
  EmStep out;
  if (!llt.Succeeded() || llt.ReciprocalCondition() < 1e-12) return out;
  out.ok = true;
  out.step = -llt.Solve(gradient.cwiseProduct(scale)).cwiseProduct(scale);
  if (with_covariance) {
    const Eigen::MatrixXd C = llt.Inverse();
    out.covariance = scale.asDiagonal() * C * scale.asDiagonal();
    out.covariance = (0.5 * (out.covariance + out.covariance.transpose())).eval();
  }
  return out;
}

EmSolution FitEm(const std::vector<EmPair>& pairs, const std::vector<double>& weights,
                 const EmDesign& design, const EmSolution& start) {
  constexpr int kIterations = 8;
  EmSolution solution = StartOf(start, design);
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    EmRows rows = RowsOf(pairs, design, solution);
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      const double root = std::sqrt(weights[i]);
      rows.J.middleRows<3>(3 * static_cast<Eigen::Index>(i)) *= root;
      rows.r.segment<3>(3 * static_cast<Eigen::Index>(i)) *= root;
    }
    Eigen::MatrixXd H = Eigen::MatrixXd::Zero(rows.J.cols(), rows.J.cols());
    H.selfadjointView<Eigen::Lower>().rankUpdate(rows.J.transpose());
    H = Eigen::MatrixXd(H.selfadjointView<Eigen::Lower>());
    const Eigen::Map<const Eigen::VectorXd> c(solution.field.coefficients.data(),
                                              design.Coefficients());
    const EmStep step = SolveStep(design, H, rows.J.transpose() * rows.r, c,
                                  solution.ok || iteration + 1 == kIterations);
    solution.ok = step.ok;
    if (!step.ok) break;
    solution = Moved(solution, design, step.step);
    solution.covariance = step.covariance;
    if (solution.covariance.size() > 0 && step.step.norm() < 1e-7) break;
  }
  return solution;
}

EmSolution RobustEm(const std::vector<EmPair>& pairs, double distance_m) {
  constexpr int kIterations = 20;
  EmSolution solution{.T_RF = ClosedForm(pairs, distance_m), .distance_m = distance_m};
  std::vector<double> weights(pairs.size(), 1.0), sigmas(pairs.size());
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    for (std::size_t i = 0; i < pairs.size(); ++i) sigmas[i] = EmSigmas(pairs[i], solution);
    const double least = 0.1 * std::max(1e-12, Median(sigmas));
    for (std::size_t i = 0; i < pairs.size(); ++i) weights[i] = least / std::max(least, sigmas[i]);
    const EmSolution next = FitEm(pairs, weights, {.free_distance = true}, solution);
    if (!next.ok) break;  // as far as it came; who calls finds out what is not known
    solution = next;
  }
  return solution;
}

}  // namespace flextip
