#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "control/direction_controller.h"
#include "core/derivative_check.h"
#include "core/linear_algebra.h"
#include "reproduction/chapter3/parts.h"

namespace flextip::reproduction {
namespace {

// Chapter 3's shaft; its stiffness is 1 N m^2, so that F_t/EI is the force.
constexpr double kLength_m = 0.355, kForce_N = 3.0;
constexpr double kDegree = std::numbers::pi / 180.0;

ShaftModel ModelAt(double depth, double force_N = kForce_N) {
  ShaftModel model;
  model.instrument = {kLength_m, 0.0, 1.0, 0.0};
  model.p_RP = {(1.0 - depth) * kLength_m, 0.0, 0.0};
  model.f_tip_N = {0.0, -force_N, 0.0};
  model.force_known = true;
  return model;
}

ShaftRodState RodOfModel(const ShaftModel& model, const Eigen::Vector3d& p_RW) {
  ShaftProblem problem;
  problem.rod.rod = {model.instrument.length_m,
                     model.instrument.bending_stiffness_Nm2,
                     p_RW,
                     model.p_RP,
                     model.f_tip_N,
                     model.weight_N_m};
  return ShaftRod().Solve(problem);
}

/// What the tip's direction can do at one insertion depth.
struct AtDepth {
  double registration_off = 0.0;  ///< the thesis's direction Jacobian against the exact, relative
  double least_mm_per_deg = 0.0;  ///< place given up for a degree, in the best direction
  double most_mm_per_deg = 0.0;   ///< in the worst
  double by_insertion_deg = 0.0;  ///< turned by 10 mm along the shaft, the rest of the place held
};

AtDepth Examine(double depth, double force_N = kForce_N) {
  const ShaftModel model = ModelAt(depth, force_N);
  const ShaftRodState rod = RodOfModel(model, Eigen::Vector3d::Zero());
  const TipJacobians J = TipJacobiansOf(rod, Eigen::Matrix3d::Zero());
  const Eigen::Matrix3d by_registration =
      DirectionByRegistration(J.position, Eigen::Vector3d::Zero(), rod.p_RE, rod.end.t);
  // d by the place: the tip's direction as its place moves.
  const Eigen::Matrix3d by_place = J.direction * J.position.inverse();
  const Eigen::Vector3d sigma = SingularValues(by_place);
  AtDepth at;
  at.registration_off = (by_registration - J.direction).norm() / J.direction.norm();
  at.least_mm_per_deg = 1e3 * kDegree / sigma[0];
  at.most_mm_per_deg = 1e3 * kDegree / sigma[1];
  at.by_insertion_deg = 0.01 * (by_place * rod.end.t).norm() / kDegree;
  return at;
}

/// Follows the controller on the rod until it rests.
DirectionOutput Settle(const DirectionOptions& options, DirectionInput& input) {
  DirectionController controller(options);
  DirectionOutput output;
  for (int i = 0; i < 40; ++i) {
    const ShaftRodState rod = RodOfModel(input.model, input.p_RW);
    input.p_RE = rod.p_RE;
    input.d_RE = rod.end.t;
    output = controller.Step(input);
    input.p_RW = output.p_RW_command;
  }
  return output;
}

DirectionInput Asking(double depth, double degrees) {
  DirectionInput input;
  input.model = ModelAt(depth);
  const ShaftRodState rod = RodOfModel(input.model, input.p_RW);
  input.p_RE = input.p_RE_desired = rod.p_RE;
  input.d_RE = rod.end.t;
  input.d_RE_desired = rod.end.t + std::tan(degrees * kDegree) * Eigen::Vector3d::UnitZ();
  return input;
}

void AddJacobianRows(std::vector<TableRow>& rows) {
  const ShaftModel model = ModelAt(0.5);
  const auto direction = [&](const Eigen::VectorXd& w) -> Eigen::VectorXd {
    return RodOfModel(model, w).end.t;
  };
  const TipJacobians J =
      TipJacobiansOf(RodOfModel(model, Eigen::Vector3d::Zero()), Eigen::Matrix3d::Zero());
  const Eigen::MatrixXd numeric = NumericJacobian(direction, Eigen::Vector3d::Zero(), 1e-3);
  rows.push_back({.quantity = "3.5 direction Jacobian against central differences, relative",
                  .thesis = {},
                  .flextip = (J.direction - numeric).norm() / numeric.norm()});
  for (const double depth : {0.3, 0.5, 0.7, 0.9}) {
    rows.push_back(
        {.quantity =
             fmt::format("3.5 direction by the registration alone, off the exact, r = {} L", depth),
         .thesis = 0.0,
         .flextip = Examine(depth).registration_off,
         .note = "The thesis lets the shape be and turns it with its chord. It is right for an "
                 "unbent shaft; a bent one's slope at the tip also changes as the port moves along "
                 "it. Relative norm, F_t held."});
  }
}

void AddReachRows(std::vector<TableRow>& rows) {
  rows.push_back({.quantity = "3.5 parts of the tip's direction free with its place held",
                  .thesis = {},
                  .flextip = 0.0,
                  .note =
                      "Three axes of the wrist, three conditions of the place. A wrist that also "
                      "holds the shaft's direction would bend it: the model's wrist is pinned."});
  for (const double depth : {0.5, 0.7}) {
    const AtDepth at = Examine(depth), straight = Examine(depth, 0.0);
    rows.push_back(
        {.quantity = fmt::format("3.5 place given up for a degree of direction, r = {} L", depth),
         .thesis = {},
         .flextip = at.least_mm_per_deg,
         .unit = "mm/deg",
         .note = fmt::format("The best way; square to it {:.2f}. A straight shaft turns about the "
                             "port: {:.2f}.",
                             at.most_mm_per_deg, straight.least_mm_per_deg)});
    rows.push_back(
        {.quantity = fmt::format("3.5 direction gained by 10 mm along the shaft, r = {} L", depth),
         .thesis = {},
         .flextip = at.by_insertion_deg,
         .unit = "deg",
         .note = "Nothing for a straight shaft; a bent one is less bent the less it is "
                 "inserted."});
  }
}

void AddControllerRows(std::vector<TableRow>& rows) {
  DirectionInput input = Asking(0.5, 5.0);
  const Eigen::Vector3d start = input.p_RE;
  DirectionOutput output = Settle({}, input);
  rows.push_back(
      {.quantity = "3.5 5 deg asked for, weighted 1 mm as 0.1 rad: place left",
       .thesis = {},
       .flextip = 1e3 * (input.p_RE - start).norm(),
       .unit = "mm",
       .note = fmt::format("Direction left {:.2f} deg.", output.direction_left_rad / kDegree)});
  input = Asking(0.5, 5.0);
  input.free_axis = Eigen::Vector3d::UnitZ();
  output = Settle({.priority = DirectionPriority::kPositionFirst}, input);
  rows.push_back(
      {.quantity = "3.5 5 deg asked for, place first but free across the bending: direction left",
       .thesis = {},
       .flextip = output.direction_left_rad / kDegree,
       .unit = "deg",
       .note = fmt::format("The tip went {:.1f} mm along the free axis and {:.4f} mm off it.",
                           1e3 * std::abs(input.p_RE.z() - start.z()),
                           1e3 * (input.p_RE - start).head<2>().norm())});
}

}  // namespace

ChapterResult Ch3Direction(const ReproduceOptions& options, const ChapterProgress& progress) {
  ChapterResult result;
  AddJacobianRows(result.rows);
  AddReachRows(result.rows);
  AddControllerRows(result.rows);
  report::Figure cost{
      .name = "fig-3-11a",
      .title = "Beyond the thesis: place given up for a degree of the tip's direction",
      .caption = "L = 0.355 m, F_t/EI = 3 1/m^2, exact rod, tip force held.",
      .x_label = "insertion depth r / L",
      .y_label = "place (mm/deg)"};
  report::Figure off{
      .name = "fig-3-11b",
      .title = "Direction by the registration alone (3.5)",
      .caption =
          "The thesis's Jacobian of the tip's direction, which leaves the shape as it "
          "is, against the exact rod's.",
      .x_label = "insertion depth r / L",
      .y_label = "relative error"};
  report::FigureTrace best{.name = "best way"}, worst{.name = "square to it"};
  report::FigureTrace straight{.name = "straight shaft", .dashed = true}, error;
  const int points = options.quick ? 15 : 47;
  for (int i = 0; i < points; ++i) {
    const double x = 0.05 + 0.9 * i / (points - 1);
    const AtDepth at = Examine(x);
    for (auto* trace : {&best, &worst, &straight, &error}) trace->x.push_back(x);
    best.y.push_back(at.least_mm_per_deg);
    worst.y.push_back(at.most_mm_per_deg);
    straight.y.push_back(Examine(x, 0.0).least_mm_per_deg);
    error.y.push_back(at.registration_off);
  }
  cost.traces = {best, worst, straight};
  off.traces = {error};
  result.figures = {cost, off};
  progress(1.0);
  return result;
}

}  // namespace flextip::reproduction
