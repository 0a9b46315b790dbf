#include "diagnosis/planning/next_motion.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "core/error.h"
#include "core/rotation.h"
#include "diagnosis/evidence/probabilities.h"
#include "diagnosis/planning/imagined_samples.h"
#include "diagnosis/planning/rivals.h"
#include "diagnosis/planning/tip_course.h"
#include "diagnosis/search/motion_library.h"

namespace flextip::diagnosis {
namespace {

using Rng = std::mt19937_64;
constexpr double kRate_hz = 12.5;
constexpr double kSettle_s = 0.25;  // after a weight was hung, which recordings leave out
constexpr double kBlock_s = 0.5;    // how finely a motion's end is found,
constexpr int kMostBlocks = 60;     // of long motions less finely
// Parts of a motion's time at which its log odds count: a motion that begins slowly is no good one.
constexpr double kOnTheWay[] = {0.075, 0.25, 1.0};
constexpr int kRandom = 40, kImprovements = 60;
// The model in which a motion is imagined is not quite the instrument: so much more is asked for.
constexpr double kMargin = 2.0;  // in log odds
const double kCertainLogOdds = std::log(kCertain / (1.0 - kCertain));
const double kEnough = kCertainLogOdds + kMargin;
constexpr double kWeightCosts = 1.3;                      // in time: a person has to hang it
constexpr double kSmallWeight = 0.4, kLargeWeight = 1.2;  // of EI / L^2
constexpr double kMostWeight_N = 6.0;
// A force across the shaft that any port bears: an unloaded recording must not forbid all weights.
constexpr double kGentle = 1.2;  // of EI / L^2

double Uniform(Rng& rng, double from, double to) {
  return std::uniform_real_distribution<double>(from, to)(rng);
}

/// What a course tells.
struct Told {
  bool possible = false;
  std::optional<double> certain_s;
  double log_odds = -1e300;  ///< of the least sure rival, at the end
  std::size_t least_sure = 0;
  double on_the_way = -1e300;  ///< sum of the log odds that count, each up to the certain ones

  /// The earlier certain the better, of the same time the surer on the way; else the surer at the
  /// end.
  bool BetterThan(const Told& other) const {
    if (possible != other.possible) return possible;
    if (certain_s.has_value() != other.certain_s.has_value()) return certain_s.has_value();
    if (!certain_s) return log_odds > other.log_odds;
    if (*certain_s != *other.certain_s) return *certain_s < *other.certain_s;
    return on_the_way > other.on_the_way;
  }
};

double Probability(double log_odds) { return 1.0 / (1.0 + std::exp(-log_odds)); }

/// Where the tip goes from its place at the recording's end, as parts of the workspace: depth in
/// [0, 1], and two turns in the unit disc.
struct Course {
  std::vector<Eigen::Vector3d> parts;
  double load_N = 0.0;
};

Eigen::Vector3d RandomPart(Rng& rng) {
  const double depth =
      Uniform(rng, 0.0, 1.0) < 0.5 ? std::round(Uniform(rng, 0.0, 1.0)) : Uniform(rng, 0.0, 1.0);
  const double radius = std::sqrt(Uniform(rng, 0.0, 1.0));
  const double angle = Uniform(rng, 0.0, 2.0 * std::numbers::pi);
  return {depth, radius * std::cos(angle), radius * std::sin(angle)};
}

Eigen::Vector3d Kept(Eigen::Vector3d part) {
  part.x() = std::clamp(part.x(), 0.0, 1.0);
  const double radius = part.tail<2>().norm();
  if (radius > 1.0) part.tail<2>() /= radius;
  return part;
}

class Planner {
 public:
  Planner(const Replay& replay, const ParameterLayout& layout, const Selection& selection,
          const Rivals& rivals, const MotionLimits& limits)
      : replay_(replay),
        layout_(layout),
        rivals_(rivals),
        set_(replay.Set()),
        weight_(1.0 / selection.memory.SamplesAsOne()),
        seconds_(limits.seconds),
        space_(RecordedWorkspace(set_)),
        speed_m_s_(limits.wrist_speed_m_s.value_or(RecordedSpeed(set_))),
        R_mean_(MeanShaftFrame(set_)),
        p_RE_start_(StraightTip(set_.samples.back().p_RW, set_.p_RP, set_.instrument.length_m)) {
    space_.inserted_from_m = limits.inserted_from_m.value_or(space_.inserted_from_m);
    space_.inserted_to_m = limits.inserted_to_m.value_or(space_.inserted_to_m);
    space_.angle_rad = limits.angle_rad.value_or(space_.angle_rad);
    const double unit_N =
        set_.instrument.bending_stiffness_Nm2 / std::pow(set_.instrument.length_m, 2);
    most_force_N_ = limits.port_force_N.value_or(std::max(MostRecordedForce(), kGentle * unit_N));
    weights_N_ = {0.0};
    if (!limits.may_hang_weight) return;
    for (const double part : {kSmallWeight, kLargeWeight})
      weights_N_.push_back(std::min(kMostWeight_N, part * unit_N));
  }

  /// The best course found.
  std::pair<Course, Told> Search() {
    Rng rng(1);
    Course best;
    Told told;
    const auto keep = [&](const Course& course) {
      const Told now = Tell(course);
      if (!now.BetterThan(told)) return;
      best = course;
      told = now;
    };
    for (int i = 0; i < kRandom; ++i) keep(RandomCourse(rng, weights_N_[i % weights_N_.size()]));
    for (int i = 0; i < kImprovements && told.possible; ++i) keep(Changed(best, rng));
    return {best, told};
  }

  /// What the samples of an imagined motion tell.
  Told Tell(SampleSet samples, double most_force_N) const {
    Told told;
    std::erase_if(samples.samples, [](const auto& sample) { return sample.t_s < kSettle_s; });
    if (samples.samples.empty()) return told;
    if (!MeasureByModel(samples, layout_, replay_.Theta())) return told;
    Replay imagined(samples, layout_);
    imagined.SetNoiseScale(replay_.NoiseScales());
    if (!imagined.Evaluate(replay_.Theta()) || imagined.FailedSamples() > 0) return told;
    for (const ReplayedSample& sample : imagined.Samples())
      if (sample.solved.lateral_force_N > most_force_N) return told;
    told.possible = true;
    const double seconds = double(samples.samples.size()) * samples.period_s;
    const int blocks = std::clamp(int(std::lround(seconds / kBlock_s)), 1, kMostBlocks);
    const LinearProblem problem = MakeLinearProblem(imagined, {}, blocks);
    std::vector<Eigen::MatrixXd> H;  // up to each block's end
    for (const NormalSums& block : problem.blocks) {
      H.emplace_back(weight_ * block.H);
      if (H.size() > 1) H.back() += H[H.size() - 2];
    }
    const auto least = rivals_.LeastSureWith(H.back());
    told.log_odds = least.log_odds;
    told.least_sure = least.rival;
    told.on_the_way = 0.0;
    for (const double part : kOnTheWay) {
      const auto block = std::size_t(std::max(0.0, std::ceil(part * double(H.size())) - 1.0));
      told.on_the_way += std::min(rivals_.LeastSureWith(H[block]).log_odds, kEnough);
    }
    if (told.log_odds < kEnough) return told;
    std::size_t low = 0, high = H.size() - 1;
    while (low < high) {
      const std::size_t middle = (low + high) / 2;
      const bool enough = rivals_.LeastSureWith(H[middle]).log_odds >= kEnough;
      (enough ? high : low) = enough ? middle : middle + 1;
    }
    told.certain_s = kSettle_s + seconds * double(high + 1) / double(H.size());
    return told;
  }

  TipCourse CourseOf(const Course& course) const {
    std::vector<Eigen::Vector3d> places{p_RE_start_};
    for (const Eigen::Vector3d& part : course.parts) {
      const double inserted =
          space_.inserted_from_m + part.x() * (space_.inserted_to_m - space_.inserted_from_m);
      const Eigen::Vector2d turn = space_.angle_rad * part.tail<2>();
      const Eigen::Vector3d axis = R_mean_.rightCols<2>() * Eigen::Vector2d(-turn.y(), turn.x());
      places.emplace_back(set_.p_RP + inserted * (ExpRotation(axis) * R_mean_.col(0)));
    }
    return {places, set_.p_RP, set_.instrument.length_m, speed_m_s_};
  }

 private:
  double MostRecordedForce() const {
    double most = 0.0;
    for (const ReplayedSample& sample : replay_.Samples())
      if (sample.ok) most = std::max(most, sample.solved.lateral_force_N);
    return most;
  }

  Course RandomCourse(Rng& rng, double load_N) const {
    Course course{{RandomPart(rng)}, load_N};
    Fill(course, rng);
    return course;
  }

  /// Adds places until the time is over.
  void Fill(Course& course, Rng& rng) const {
    while (CourseOf(course).Seconds() < seconds_) course.parts.push_back(RandomPart(rng));
    while (course.parts.size() > 1) {
      Course shorter = course;
      shorter.parts.pop_back();
      if (CourseOf(shorter).Seconds() < seconds_) break;
      course = shorter;
    }
  }

  Course Changed(Course course, Rng& rng) const {
    const auto i = std::uniform_int_distribution<std::size_t>(0, course.parts.size() - 1)(rng);
    if (Uniform(rng, 0.0, 1.0) < 0.5) {
      course.parts[i] = RandomPart(rng);
    } else {
      for (double& x : course.parts[i]) x += Uniform(rng, -0.4, 0.4);
      course.parts[i] = Kept(course.parts[i]);
    }
    Fill(course, rng);
    return course;
  }

  Told Tell(const Course& course) const {
    const TipCourse tip = CourseOf(course);
    const ImaginedMotion motion{.seconds = std::min(seconds_, tip.Seconds()),
                                .rate_hz = kRate_hz,
                                .load_N = course.load_N,
                                .at = [&](double t_s) {
                                  return ImaginedInstant{tip.Wrist(t_s), 0.0};
                                }};
    Told told = Tell(ImagineSamples(set_, motion), most_force_N_);
    if (told.certain_s && course.load_N > 0.0) *told.certain_s *= kWeightCosts;
    return told;
  }

  const Replay& replay_;
  const ParameterLayout& layout_;
  const Rivals& rivals_;
  const SampleSet& set_;
  double weight_, seconds_;
  Workspace space_;
  double speed_m_s_, most_force_N_ = 0.0;
  Eigen::Matrix3d R_mean_;
  Eigen::Vector3d p_RE_start_;
  std::vector<double> weights_N_;
};

void CompareLibrary(const Planner& planner, const SampleSet& recorded, NextMotion& plan) {
  Told best;
  for (const LibraryMotion& motion : MotionLibrary(recorded)) {
    const Told told = planner.Tell(motion.samples, 1e300);
    if (!told.BetterThan(best)) continue;
    best = told;
    plan.library_motion = motion.text;
  }
  plan.library_seconds_to_certain = best.certain_s;
  plan.library_probability = best.possible ? Probability(best.log_odds) : 0.0;
}

}  // namespace

void RequireUsable(const MotionLimits& limits, const SampleSet& recorded, const std::string& name) {
  const Workspace space = RecordedWorkspace(recorded);
  const double from = limits.inserted_from_m.value_or(space.inserted_from_m);
  const double to = limits.inserted_to_m.value_or(space.inserted_to_m);
  const double length = recorded.instrument.length_m;
  if (!(from > 0.0 && from < to && to < length)) {
    throw InputError(fmt::format(
        "{}: a motion cannot be planned from {:g} to {:g} m beyond the port: expected a depth "
        "above 0, then a larger one below the shaft's {:g} m",
        name, from, to, length));
  }
  const double speed = limits.wrist_speed_m_s.value_or(RecordedSpeed(recorded));
  if (!(speed > 0.0)) {
    throw InputError(fmt::format(
        "{}: a motion cannot be planned at the wrist's recorded speed, which is 0: give one",
        name));
  }
}

NextMotion PlanNextMotion(const Replay& replay, const Selection& selection,
                          const std::vector<std::vector<std::string>>& groups,
                          const MotionLimits& limits) {
  const ParameterLayout& layout = replay.Layout();
  std::vector<std::vector<int>> blocks;
  for (const auto& group : groups) {
    blocks.emplace_back();
    for (const std::string& name : group) blocks.back().push_back(layout.Find(name));
  }
  const Rivals rivals(selection, layout, blocks);
  NextMotion plan;
  for (const Rival& rival : rivals.All())
    plan.rivals.push_back(VerdictOf(rival.hypothesis, layout));
  const Eigen::MatrixXd nothing = Eigen::MatrixXd::Zero(layout.Size(), layout.Size());
  const double log_odds_now = rivals.LeastSureWith(nothing).log_odds;
  plan.probability_now = Probability(log_odds_now);
  plan.needed = log_odds_now < kCertainLogOdds;
  if (!plan.needed) return plan;
  Planner planner(replay, layout, selection, rivals, limits);
  const auto [course, told] = planner.Search();
  if (told.possible) {
    const TipCourse tip = planner.CourseOf(course);
    plan.load_N = course.load_N;
    plan.speed_m_s = tip.Speed();
    plan.probability = Probability(told.log_odds);
    plan.least_sure = plan.rivals[told.least_sure];
    plan.seconds_to_certain = told.certain_s;
    if (told.certain_s && course.load_N > 0.0) *plan.seconds_to_certain /= kWeightCosts;
    plan.seconds = std::min(limits.seconds, plan.seconds_to_certain.value_or(limits.seconds));
    plan.places_m = tip.PlacesUntil(plan.seconds);
  }
  CompareLibrary(planner, replay.Set(), plan);
  return plan;
}

}  // namespace flextip::diagnosis
