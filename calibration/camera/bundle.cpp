#include "calibration/camera/bundle.h"

#include <ceres/ceres.h>
#include <ceres/normal_prior.h>
#include <glog/logging.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>

#include "calibration/camera/corner_error.h"
#include "calibration/camera/normal.h"
#include "calibration/camera/projection_derivative.h"
#include "calibration/camera/shape_elimination.h"
#include "core/check.h"
#include "core/matrix_types.h"
#include "core/rotation.h"

namespace flextip {
namespace {

using PoseStep = Vector6d;

// What Ceres moves.
struct Parameters {
  Eigen::VectorXd intrinsics;
  Eigen::Vector2d warp_m;
  std::vector<PoseStep> steps;
  std::map<int, Eigen::Vector3d> places;  // of the corners used, where the shape is estimated

  explicit Parameters(const CameraSolution& s)
      : intrinsics(IntrinsicsVector(s.camera)),
        warp_m(s.warp.bulge_m),
        steps(s.views.size(), PoseStep::Zero()) {}

  bool Finite() const {
    return intrinsics.allFinite() && intrinsics[0] > 0 && intrinsics[1] > 0 && warp_m.allFinite() &&
           std::all_of(steps.begin(), steps.end(), [](const auto& p) { return p.allFinite(); }) &&
           std::all_of(places.begin(), places.end(),
                       [](const auto& p) { return p.second.allFinite(); });
  }

  void MoveInto(CameraSolution& s) const {
    s.camera = WithIntrinsics(s.camera, intrinsics);
    s.warp.bulge_m = warp_m;
    for (std::size_t v = 0; v < s.views.size(); ++v) {
      Pose& T_CB = s.views[v].T_CB;
      T_CB.R = ExpRotation(steps[v].head<3>()) * T_CB.R;
      T_CB.R = Eigen::Quaterniond(T_CB.R).normalized().toRotationMatrix();
      T_CB.p += steps[v].tail<3>();
    }
    if (!places.empty()) s.shape.offset_B = places;  // of corners not seen nothing is known
  }
};

void AddCorners(const CameraSolution& s, const BundleOptions& options, Parameters& at,
                ceres::Problem& problem) {
  ceres::LossFunction* loss =
      options.cauchy_px > 0 ? new ceres::CauchyLoss(options.cauchy_px) : nullptr;
  for (std::size_t v = 0; v < s.views.size(); ++v) {
    const SolvedView& view = s.views[v];
    for (std::size_t i = 0; i < view.px.size(); ++i) {
      if (!view.IsUsed(i)) continue;
      std::vector<double*> blocks = {at.intrinsics.data(), at.warp_m.data(), at.steps[v].data()};
      if (options.estimate_shape) {
        const int id = view.ids[i];
        blocks.push_back(at.places.try_emplace(id, s.shape.Of(id)).first->second.data());
      }
      auto error = MakeCornerError(s, view, i, options.estimate_shape);
      problem.AddResidualBlock(error.release(), loss, blocks);
    }
  }
  const double weight = options.estimate_shape ? ShapeWeight(s.noise_px, s.shape) : 0.0;
  for (auto& [id, place] : at.places) {
    problem.AddResidualBlock(
        new ceres::NormalPrior(weight * Eigen::Matrix3d::Identity(), Eigen::Vector3d::Zero()),
        nullptr, place.data());
  }
}

// A step that cannot be solved for is taken again with more damping; Ceres writes it to stderr.
class QuietLog {
 public:
  QuietLog() : level_(FLAGS_minloglevel) { FLAGS_minloglevel = google::GLOG_FATAL; }
  ~QuietLog() { FLAGS_minloglevel = level_; }
  QuietLog(const QuietLog&) = delete;
  QuietLog& operator=(const QuietLog&) = delete;

 private:
  int level_;
};

// Eliminated first are the many small blocks that do not touch each other: the corners' places, or
// where those are held the poses.
std::shared_ptr<ceres::ParameterBlockOrdering> Ordering(const ceres::Problem& problem,
                                                        Parameters& at) {
  auto ordering = std::make_shared<ceres::ParameterBlockOrdering>();
  ordering->AddElementToGroup(at.intrinsics.data(), 1);
  ordering->AddElementToGroup(at.warp_m.data(), 1);
  for (auto& [id, place] : at.places) ordering->AddElementToGroup(place.data(), 0);
  for (PoseStep& step : at.steps) {
    if (!problem.HasParameterBlock(step.data())) continue;
    ordering->AddElementToGroup(step.data(), at.places.empty() ? 0 : 1);
  }
  return ordering;
}

bool Minimise(const CameraSolution& s, const BundleOptions& options, Parameters& at) {
  ceres::Problem problem;
  AddCorners(s, options, at, problem);
  if (problem.NumResidualBlocks() == 0) return false;
  if (options.fix_intrinsics) {
    problem.SetParameterBlockConstant(at.intrinsics.data());
  } else if (!options.fixed.empty()) {
    problem.SetManifold(
        at.intrinsics.data(),
        new ceres::SubsetManifold(static_cast<int>(at.intrinsics.size()), options.fixed));
  }
  if (!options.estimate_warp) problem.SetParameterBlockConstant(at.warp_m.data());
  ceres::Solver::Options solver;
  solver.linear_solver_type = ceres::DENSE_SCHUR;
  solver.linear_solver_ordering = Ordering(problem, at);
  solver.max_num_iterations = options.max_iterations;
  // Always some damping: parameters that the views do not tell would make the matrix singular. So
  // little that what they hardly tell (8 terms) converges too.
  solver.max_trust_region_radius = 1e11;
  solver.function_tolerance = options.tolerance;
  solver.parameter_tolerance = 1e-11;
  solver.gradient_tolerance = 1e-12;
  solver.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  const QuietLog quiet;
  ceres::Solve(solver, &problem, &summary);
  return summary.IsSolutionUsable() && at.Finite();
}

}  // namespace

bool AdjustBundle(CameraSolution& solution, const BundleOptions& options) {
  CameraSolution moved = solution;
  moved.warp_estimated = options.estimate_warp;
  FLEXTIP_CHECK(!options.estimate_shape || (moved.shape.sd_m > 0 && moved.noise_px > 0),
                "a prior for the shape that is estimated");
  Parameters at(moved);
  if (!Minimise(moved, options, at)) return false;
  at.MoveInto(moved);
  if (!EvaluateSolution(options, moved)) return false;
  solution = std::move(moved);
  return true;
}

}  // namespace flextip
