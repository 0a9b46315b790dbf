#include "calibration/hand_eye/motion.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/linear_algebra.h"
#include "core/rotation.h"

namespace flextip {
namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;
// A motion along an axis counts where its spread is this many times its noise.
constexpr double kBeyondNoise = 4.0;
// Directions known to no better than this are not known; metres as a part of the distance.
constexpr double kKnown_rad = 0.05, kKnownOfDistance = 0.05;
constexpr double kLeastPart = 0.02;             // of a coordinate in what is not known, squared
constexpr double kVelocitiesBeyondNoise = 3.0;  // mean square over that of their noise
constexpr double kMostBend = 0.3;               // of the way between two samples, off its middle
constexpr std::size_t kMostMotions = 5;

// The part of the vectors (about their mean) in directions with a spread beyond `noise`.
struct Spread {
  Eigen::Matrix3d projector = Eigen::Matrix3d::Zero();
  int directions = 0;
  Eigen::Vector3d widest = Eigen::Vector3d::Zero();
};

Spread SpreadOf(const std::vector<Eigen::Vector3d>& vectors, const Eigen::Vector3d& mean,
                double noise) {
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const auto& v : vectors) scatter += (v - mean) * (v - mean).transpose();
  scatter /= std::max<double>(1, static_cast<double>(vectors.size()) - 1);
  const SymmetricEigen eigen(scatter);
  Spread spread;
  for (int i = 2; i >= 0; --i) {
    if (eigen.values[i] < std::pow(kBeyondNoise * noise, 2)) break;
    spread.projector += eigen.vectors.col(i) * eigen.vectors.col(i).transpose();
    ++spread.directions;
  }
  spread.widest = eigen.vectors.col(2);
  return spread;
}

Eigen::Matrix3d MeanRotation(const std::vector<Pose>& poses) {
  Eigen::Matrix3d mean = poses.front().R;
  for (int i = 0; i < 10; ++i) {
    Eigen::Vector3d step = Eigen::Vector3d::Zero();
    for (const Pose& T : poses) step += LogRotation(T.R * mean.transpose());
    mean = ExpRotation(step / static_cast<double>(poses.size())) * mean;
  }
  return mean;
}

double MeanDistance(const HandEyeProblem& problem, const HandEyeState& state) {
  double sum = 0;
  for (const FitView& view : problem.views) {
    sum += BoardInCamera(problem.mount, state.T_FC, state.T_KB, view.wrist.T_RW).p.norm();
  }
  return sum / static_cast<double>(problem.views.size());
}

// Information of a view with the wrist at T_RW, as if it had been seen where it is expected; empty
// where it cannot be seen.
std::optional<SharedMatrix> ExpectedInformation(const HandEyeProblem& problem,
                                                const HandEyeState& state,
                                                const CameraModel& camera, const FitView& like,
                                                const Pose& T_RW) {
  FitView view = like;
  view.wrist.T_RW = T_RW;
  const auto normal = NormalOf(problem, view, camera, state, T_RW);
  if (!normal) return {};
  return normal->Reduced();
}

SharedMatrix CleanedInformation(const HandEyeProblem& problem, const HandEyeState& state,
                                const WristMotion& motion) {
  const CameraModel camera(state.camera);
  SharedMatrix H = SharedMatrix::Zero(kShared, kShared);
  for (std::size_t i = 0; i < problem.views.size(); ++i) {
    const auto one =
        ExpectedInformation(problem, state, camera, problem.views[i], motion.cleaned[i]);
    if (one) H += *one;
  }
  return H;
}

// Of the first twelve numbers, the others marginalised where they are unknown.
Eigen::MatrixXd OfPoses(const SharedMatrix& H, const std::vector<int>& unknowns) {
  const Eigen::MatrixXd all = H(unknowns, unknowns);
  const Eigen::Index others = all.rows() - 12;
  if (others == 0) return all;
  const Eigen::MatrixXd cross = all.topRightCorner(12, others);
  return all.topLeftCorner(12, 12) -
         cross * Ldlt(all.bottomRightCorner(others, others)).Solve(cross.transpose());
}

std::string WhyUnknown(const WristMotion& motion, double sd, const char* unit) {
  if (motion.axes == 0) {
    return "the wrist did not turn: where the camera is cannot be told from where the board is";
  }
  if (motion.axes == 1) {
    return fmt::format(
        "the wrist turned about one axis only, ({:.2f}, {:.2f}, {:.2f}): along it, and where it "
        "did "
        "not shift also about it, camera and board can move together unseen",
        motion.axis_R.x(), motion.axis_R.y(), motion.axis_R.z());
  }
  return fmt::format(
      "the views are too few or too much alike (the wrist turned by {:.1f} deg at "
      "most): known to {:.2g} {} only",
      kDegrees * motion.largest_turn_rad, sd, unit);
}

}  // namespace

WristMotion MotionOf(const std::vector<Pose>& T_RW, const HandEyeNoise& noise) {
  WristMotion motion;
  if (T_RW.empty()) return motion;
  const Eigen::Matrix3d mean = MeanRotation(T_RW);
  std::vector<Eigen::Vector3d> turns, places;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  for (const Pose& T : T_RW) {
    turns.push_back(LogRotation(T.R * mean.transpose()));
    places.push_back(T.p);
    centre += T.p / static_cast<double>(T_RW.size());
    motion.largest_turn_rad = std::max(motion.largest_turn_rad, turns.back().norm());
  }
  const Spread turned = SpreadOf(turns, Eigen::Vector3d::Zero(), noise.orientation_rad);
  const Spread shifted = SpreadOf(places, centre, noise.position_m);
  motion.axes = turned.directions;
  motion.directions = shifted.directions;
  motion.axis_R = turned.widest;
  for (std::size_t i = 0; i < T_RW.size(); ++i) {
    motion.cleaned.push_back({ExpRotation(turned.projector * turns[i]) * mean,
                              centre + shifted.projector * (places[i] - centre)});
  }
  return motion;
}

std::vector<Calibration::Unobservable> UnknownCoordinates(const HandEyeProblem& problem,
                                                          const HandEyeState& state,
                                                          const WristMotion& motion) {
  const Eigen::MatrixXd H = OfPoses(CleanedInformation(problem, state, motion), problem.Unknowns());
  const double known_m = kKnownOfDistance * MeanDistance(problem, state);
  Eigen::VectorXd limit(12);
  limit << Eigen::Vector3d::Constant(kKnown_rad), Eigen::Vector3d::Constant(known_m),
      Eigen::Vector3d::Constant(kKnown_rad), Eigen::Vector3d::Constant(known_m);
  const Eigen::MatrixXd scaled = limit.asDiagonal() * H * limit.asDiagonal();
  const SymmetricEigen eigen(scaled);
  Eigen::VectorXd part = Eigen::VectorXd::Zero(12), variance = Eigen::VectorXd::Zero(12);
  for (int i = 0; i < 12 && eigen.values[i] < 1.0; ++i) {
    const Eigen::VectorXd squared = eigen.vectors.col(i).cwiseAbs2();
    part += squared;
    variance += squared / std::max(eigen.values[i], 1e-12);
  }
  std::vector<Calibration::Unobservable> unknown;
  for (int i = 0; i < 12; ++i) {
    if (part[i] < kLeastPart) continue;
    const bool angle = i % 6 < 3;
    const double sd = std::sqrt(variance[i]) * limit[i];
    unknown.push_back(
        {fmt::format("{}.{}[{}]", i < 6 ? "camera" : "board", angle ? "w" : "p", i % 3),
         WhyUnknown(motion, angle ? kDegrees * sd : 1e3 * sd, angle ? "deg" : "mm")});
  }
  return unknown;
}

std::string NoTimeOffsetReason(const HandEyeProblem& problem) {
  const Matrix6d weight = Lu(problem.noise.WristCovariance()).Inverse();
  double velocities = 0, of_noise = 0, steps = 0, bends = 0;
  int with = 0;
  for (const FitView& view : problem.views) {
    const WristAtView& wrist = view.wrist;
    if (!wrist.velocity) continue;
    ++with;
    velocities += wrist.velocity->dot(weight * *wrist.velocity);
    of_noise += 6 * wrist.velocity_noise_1_s2;
    steps += wrist.step.dot(weight * wrist.step);
    bends += wrist.bend.dot(weight * wrist.bend);
  }
  if (2 * with < static_cast<int>(problem.views.size())) {
    return "the wrist was not recorded closely enough around the pictures to know how fast it "
           "moved";
  }
  if (velocities < kVelocitiesBeyondNoise * of_noise) {
    return "the wrist stood still when the pictures were taken: any offset gives the same chain";
  }
  if (bends > kMostBend * kMostBend * steps) {
    return "the wrist was recorded too rarely to follow how it moved around the pictures";
  }
  return {};
}

namespace {

struct Candidate {
  const char* words;
  Eigen::Vector3d turn_C;  // rad, about the board's middle
  Eigen::Vector3d shift;   // of its distance
};

std::vector<Candidate> Candidates() {
  const double tilt = 30 / kDegrees, turn = 60 / kDegrees;
  const Eigen::Vector3d none = Eigen::Vector3d::Zero();
  return {{"tilt the board by 30 deg, its upper edge toward the camera", {tilt, 0, 0}, none},
          {"tilt the board by 30 deg, its lower edge toward the camera", {-tilt, 0, 0}, none},
          {"tilt the board by 30 deg, its right edge toward the camera", {0, tilt, 0}, none},
          {"tilt the board by 30 deg, its left edge toward the camera", {0, -tilt, 0}, none},
          {"turn the board by 60 deg clockwise in the picture", {0, 0, turn}, none},
          {"turn the board by 60 deg anticlockwise in the picture", {0, 0, -turn}, none},
          {"bring the board nearer by a quarter of its distance", none, {0, 0, -0.25}},
          {"move the board away by half its distance", none, {0, 0, 0.5}},
          {"move the board to the left of the picture", none, {-0.15, 0, 0}},
          {"move the board to the right of the picture", none, {0.15, 0, 0}},
          {"move the board to the top of the picture", none, {0, -0.1, 0}},
          {"move the board to the bottom of the picture", none, {0, 0.1, 0}}};
}

Eigen::Vector3d Middle(const FitView& view) {
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (const auto& p : view.points) middle += p.x_E / static_cast<double>(view.points.size());
  return middle;
}

bool InPicture(const CameraModel& camera, const FitView& view, const Pose& T_CB) {
  const CameraCalibration& c = camera.Calibration();
  return std::all_of(view.points.begin(), view.points.end(), [&](const Correspondence& point) {
    const auto px = camera.Project(T_CB * point.x_E);
    return px && px->x() > 0 && px->y() > 0 && px->x() < c.width_px && px->y() < c.height_px;
  });
}

// Of a point at x_C carried to F; what nothing is known of counts as a radian and a metre.
double PointSd(const Eigen::MatrixXd& H_poses, const Eigen::Matrix3d& R_FC,
               const Eigen::Vector3d& x_C) {
  const Eigen::MatrixXd C =
      Lu(H_poses + Eigen::MatrixXd::Identity(12, 12)).Inverse().topLeftCorner(6, 6);
  Eigen::Matrix<double, 3, 6> J;
  J << -Skew(R_FC * x_C), Eigen::Matrix3d::Identity();
  return std::sqrt((J * C * J.transpose()).trace());
}

}  // namespace

std::vector<HandEyeMotion> HelpfulMotions(const HandEyeProblem& problem, const HandEyeState& state,
                                          const WristMotion& motion) {
  const CameraModel camera(state.camera);
  const FitView& like = *std::max_element(
      problem.views.begin(), problem.views.end(),
      [](const FitView& a, const FitView& b) { return a.points.size() < b.points.size(); });
  const Pose T_FK = WristInChain(
      problem.mount, motion.cleaned[static_cast<std::size_t>(&like - problem.views.data())]);
  const Pose T_CB = state.T_FC.Inverse() * T_FK * state.T_KB;
  const Eigen::Vector3d middle_B = Middle(like), middle_C = T_CB * middle_B;
  const SharedMatrix H = CleanedInformation(problem, state, motion);
  const auto unknowns = problem.Unknowns();
  const double before = PointSd(OfPoses(H, unknowns), state.T_FC.R, middle_C);
  std::vector<HandEyeMotion> motions;
  for (const Candidate& candidate : Candidates()) {
    Pose next{ExpRotation(candidate.turn_C) * T_CB.R, {}};
    next.p = middle_C + candidate.shift * middle_C.z() - next.R * middle_B;
    if (!InPicture(camera, like, next)) continue;
    const Pose T_RW = WristInChain(problem.mount, state.T_FC * next * state.T_KB.Inverse());
    const auto more = ExpectedInformation(problem, state, camera, like, T_RW);
    if (!more) continue;
    const double after = PointSd(OfPoses(H + *more, unknowns), state.T_FC.R, middle_C);
    motions.push_back({candidate.words, before, after});
  }
  std::sort(motions.begin(), motions.end(), [](const HandEyeMotion& a, const HandEyeMotion& b) {
    return a.sd_after_m < b.sd_after_m;
  });
  if (motions.size() > kMostMotions) motions.resize(kMostMotions);
  return motions;
}

}  // namespace flextip
