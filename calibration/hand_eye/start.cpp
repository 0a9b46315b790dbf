#include "calibration/hand_eye/start.h"

#include <algorithm>
#include <cmath>
#include <random>

#include "core/draw_vector.h"
#include "core/levenberg_marquardt.h"
#include "core/linear_algebra.h"
#include "core/rotation.h"

namespace flextip {
namespace {

constexpr int kTriples = 150, kRandomRotations = 24, kRefined = 16, kIterations = 40;
constexpr double kDof = 6.0;
// Relative turns of wrist and board may differ by this (rad) in a hypothesis, and by less than that
// a motion has no axis.
constexpr double kSameAngle_rad = 0.25, kLeastAngle_rad = 0.03;

struct Hypothesis {
  Pose T_FC, T_KB;
  double score = 0.0;
};

struct Match {
  int candidate = 0;
  double chi2 = HUGE_VAL;
  Vector6d r = Vector6d::Zero();  // from the candidate to the chain, (dw, dp) in C
  Matrix6d weight = Matrix6d::Zero();
};

// The candidate that fits the chain best.
Match BestMatch(const PoseView& view, const Pose& T_CB, const Matrix6d& J_wrist) {
  const Matrix6d of_wrist = J_wrist * view.wrist_covariance * J_wrist.transpose();
  Match best;
  for (std::size_t i = 0; i < view.candidates.size(); ++i) {
    const PoseCandidate& candidate = view.candidates[i];
    const Vector6d r = PoseDifference(candidate.T_CB, T_CB);
    const Matrix6d weight = Lu(candidate.covariance + of_wrist).Inverse();
    const double chi2 = r.dot(weight * r) + candidate.penalty;
    if (chi2 < best.chi2) best = {static_cast<int>(i), chi2, r, weight};
  }
  return best;
}

struct Sum {
  double score = 0.0;
  Eigen::Matrix<double, 12, 12> H = Eigen::Matrix<double, 12, 12>::Zero();
  Eigen::Matrix<double, 12, 1> g = Eigen::Matrix<double, 12, 1>::Zero();
};

Sum Evaluate(HandEyeMount mount, const std::vector<PoseView>& views, const Pose& T_FC,
             const Pose& T_KB) {
  Sum sum;
  for (const PoseView& view : views) {
    const auto J = ChainJacobian(mount, T_FC, T_KB, view.T_RW);
    const Match match =
        BestMatch(view, BoardInCamera(mount, T_FC, T_KB, view.T_RW), J.rightCols<6>());
    const Eigen::Matrix<double, 6, 12> J12 = J.leftCols<12>();
    const double trust = 1.0 / (1.0 + match.chi2 / kDof);
    sum.score += std::log1p(match.chi2 / kDof);
    sum.H.noalias() += trust * J12.transpose() * match.weight * J12;
    sum.g.noalias() += trust * J12.transpose() * (match.weight * match.r);
  }
  return sum;
}

Hypothesis Refine(HandEyeMount mount, const std::vector<PoseView>& views, Hypothesis at) {
  Sum sum = Evaluate(mount, views, at.T_FC, at.T_KB), there;
  Hypothesis next;
  const auto try_step = [&](double damping) -> TrialStep {
    const Eigen::VectorXd step = DampedStep(sum.H, sum.g, damping);
    next = {MovePose(at.T_FC, step.head<6>()), MovePose(at.T_KB, step.tail<6>())};
    there = Evaluate(mount, views, next.T_FC, next.T_KB);
    return {.cost = there.score};
  };
  const auto accept = [&] {
    at = next;
    sum = there;
  };
  Descend(sum.score, try_step, accept,
          {.max_iterations = kIterations,
           .start_damping = 1e-3,
           .shrink = 0.2,
           .grow = 6.0,
           .least_damping = 1e-9,
           .floor = 1e-9,
           .most_damping = 1e6,
           .relative_gain = 1e-7});
  at.score = sum.score;
  return at;
}

// With the rotations given: R_FK p_KB - p_FC = R_FC p_CB - p_FK of all views, least squares of
// least norm where the motion leaves some of it open.
void FillTranslations(HandEyeMount mount, const std::vector<const PoseView*>& views,
                      const std::vector<const Pose*>& seen, Hypothesis& h) {
  Eigen::MatrixXd A(3 * views.size(), 6);
  Eigen::VectorXd b(3 * views.size());
  for (std::size_t i = 0; i < views.size(); ++i) {
    const Pose T_FK = WristInChain(mount, views[i]->T_RW);
    const auto row = static_cast<Eigen::Index>(3 * i);
    A.block<3, 3>(row, 0) = -Eigen::Matrix3d::Identity();
    A.block<3, 3>(row, 3) = T_FK.R;
    b.segment<3>(row) = h.T_FC.R * seen[i]->p - T_FK.p;
  }
  const Eigen::VectorXd p = CompleteOrthogonal(A, 1e-3).Solve(b);
  h.T_FC.p = p.head<3>();
  h.T_KB.p = p.tail<3>();
}

Eigen::Matrix3d NearestRotation(const Eigen::Matrix3d& M) {
  const Svd svd(M);
  Eigen::Matrix3d flip = Eigen::Matrix3d::Identity();
  flip(2, 2) = (svd.U * svd.V.transpose()).determinant();
  return svd.U * flip * svd.V.transpose();
}

// The rotation of three views with one candidate each, by the axes of their relative motions (Park
// and Martin 1994); false where the turns do not match or have no two axes.
bool AlignAxes(HandEyeMount mount, const std::vector<const PoseView*>& views,
               const std::vector<const Pose*>& seen, Eigen::Matrix3d& R_FC) {
  Eigen::Matrix3d M = Eigen::Matrix3d::Zero();
  Eigen::Vector3d axes[2];
  const Eigen::Matrix3d R_FK0 = WristInChain(mount, views[0]->T_RW).R;
  for (int i = 0; i < 2; ++i) {
    const Eigen::Matrix3d R_FK = WristInChain(mount, views[i + 1]->T_RW).R;
    const Eigen::Vector3d a_F = LogRotation(R_FK * R_FK0.transpose());
    const Eigen::Vector3d a_C = LogRotation(seen[i + 1]->R * seen[0]->R.transpose());
    if (std::abs(a_F.norm() - a_C.norm()) > kSameAngle_rad) return false;
    M += a_F * a_C.transpose();
    axes[i] = a_F;
  }
  if (axes[0].cross(axes[1]).norm() < kLeastAngle_rad * std::max(axes[0].norm(), axes[1].norm())) {
    return false;
  }
  R_FC = NearestRotation(M);
  return true;
}

void AddOfTriple(HandEyeMount mount, const std::vector<PoseView>& views,
                 const std::array<std::size_t, 3>& triple, std::vector<Hypothesis>& hypotheses) {
  const std::vector<const PoseView*> three = {&views[triple[0]], &views[triple[1]],
                                              &views[triple[2]]};
  for (int choice = 0; choice < 8; ++choice) {
    std::vector<const Pose*> seen;
    for (int i = 0; i < 3; ++i) {
      const auto& candidates = three[i]->candidates;
      const std::size_t which = (choice >> i) & 1;
      if (which < candidates.size()) seen.push_back(&candidates[which].T_CB);
    }
    Hypothesis h;
    if (seen.size() < 3 || !AlignAxes(mount, three, seen, h.T_FC.R)) continue;
    h.T_KB.R = WristInChain(mount, three[0]->T_RW).R.transpose() * h.T_FC.R * seen[0]->R;
    FillTranslations(mount, three, seen, h);
    h.score = Evaluate(mount, views, h.T_FC, h.T_KB).score;
    hypotheses.push_back(h);
  }
}

std::array<std::size_t, 3> RandomTriple(std::size_t count, std::mt19937& random) {
  std::uniform_int_distribution<std::size_t> any(0, count - 1);
  std::array<std::size_t, 3> triple{};
  do {
    for (auto& i : triple) i = any(random);
  } while (triple[0] == triple[1] || triple[1] == triple[2] || triple[0] == triple[2]);
  return triple;
}

Hypothesis OfRandomRotation(HandEyeMount mount, const std::vector<PoseView>& views,
                            std::mt19937& random) {
  std::normal_distribution<double> normal;
  const Eigen::Vector4d wxyz = DrawVector<4>(normal, random);
  const Eigen::Quaterniond q(wxyz[0], wxyz[1], wxyz[2], wxyz[3]);
  Hypothesis h;
  h.T_FC.R = q.normalized().toRotationMatrix();
  std::vector<const PoseView*> all;
  std::vector<const Pose*> seen;
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (const PoseView& view : views) {
    all.push_back(&view);
    seen.push_back(&view.candidates.front().T_CB);
    sum += WristInChain(mount, view.T_RW).R.transpose() * h.T_FC.R * seen.back()->R;
  }
  h.T_KB.R = NearestRotation(sum);
  FillTranslations(mount, all, seen, h);
  return h;
}

}  // namespace

HandEyeStart RefineHandEyeStart(HandEyeMount mount, const std::vector<PoseView>& views,
                                const Pose& T_FC, const Pose& T_KB) {
  const Hypothesis h = Refine(mount, views, {T_FC, T_KB, 0.0});
  HandEyeStart start{h.T_FC, h.T_KB, h.score, {}};
  for (const PoseView& view : views) {
    const auto J = ChainJacobian(mount, h.T_FC, h.T_KB, view.T_RW);
    const Pose T_CB = BoardInCamera(mount, h.T_FC, h.T_KB, view.T_RW);
    start.chosen.push_back(BestMatch(view, T_CB, J.rightCols<6>()).candidate);
  }
  return start;
}

std::optional<HandEyeStart> FindHandEyeStart(HandEyeMount mount, const std::vector<PoseView>& views,
                                             unsigned seed) {
  if (views.size() < 3) return {};
  std::mt19937 random(seed);
  std::vector<Hypothesis> hypotheses;
  for (int i = 0; i < kTriples; ++i) {
    AddOfTriple(mount, views, RandomTriple(views.size(), random), hypotheses);
  }
  std::sort(hypotheses.begin(), hypotheses.end(),
            [](const Hypothesis& a, const Hypothesis& b) { return a.score < b.score; });
  if (hypotheses.size() > kRefined) hypotheses.resize(kRefined);
  for (int i = 0; i < kRandomRotations; ++i) {
    hypotheses.push_back(OfRandomRotation(mount, views, random));
  }
  Hypothesis best;
  best.score = HUGE_VAL;
  for (const Hypothesis& h : hypotheses) {
    const Hypothesis refined = Refine(mount, views, h);
    if (refined.score < best.score) best = refined;
  }
  return RefineHandEyeStart(mount, views, best.T_FC, best.T_KB);
}

}  // namespace flextip
