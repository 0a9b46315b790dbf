#include "control/joints/joint_feed_forward.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/error.h"

namespace flextip {
namespace {

constexpr double kAbsurd = 1e4;         // rad, m, their rates, Nm and N beyond this are not meant
constexpr double kLongest_s = 1.0;      // between two commands
constexpr double kEffortRate_s = 0.02;  // an effort's rate counts by its mean over such a time
constexpr double kSingular = 1e-3;
constexpr double kStill_rad_s = 1e-3, kStill_m_s = 1e-4;  // slower than this nothing turns back

JointVector OrUsual(const JointVector& given, const JointModel& model, double rad, double m,
                    const char* name) {
  JointVector usual(model.size);
  for (int i = 0; i < model.size; ++i) usual[i] = model.turns[std::size_t(i)] ? rad : m;
  if (given.size() == 0) return usual;
  if (given.size() != model.size || !given.allFinite() || given.minCoeff() < 0.0) {
    throw InputError(fmt::format("feed-forward: {}: expected {} numbers of at least 0, found {}",
                                 name, model.size, given.size()));
  }
  return given;
}

void Require(const JointVector& numbers, int size, const char* name, double least = -1e300) {
  if (numbers.size() != size || !numbers.allFinite() || numbers.minCoeff() < least) {
    throw InputError(fmt::format("feed-forward: {}: expected {} finite numbers{}", name, size,
                                 least == 0.0 ? " of at least 0" : ""));
  }
}

void Require(const JointMatrix& numbers, int size, const char* name) {
  if (numbers.rows() != size || numbers.cols() != size || !numbers.allFinite())
    throw InputError(
        fmt::format("feed-forward: {}: expected {} x {} finite numbers", name, size, size));
}

void Check(const JointModel& model) {
  Require(model.lag_s, model.size, "lag_s", 0.0);
  Require(model.inertia_s2, model.size, "inertia_s2");
  Require(model.droop, model.size, "droop", 0.0);
  Require(model.offset, model.size, "offset");
  Require(model.scale, model.size, "scale");
  Require(model.compliance, model.size, "compliance", 0.0);
  Require(model.coupling, model.size, "coupling");
  Require(model.play, model.size, "play");
  if (!(model.delay_s >= 0.0 && model.delay_s < kLongest_s)) {
    throw InputError(fmt::format("feed-forward: delay_s: found {}, expected 0 to {}", model.delay_s,
                                 kLongest_s));
  }
  if (model.effort && model.effort->Size() != model.size)
    throw InputError("feed-forward: the efforts are of another arm");
}

}  // namespace

const char* Name(FeedForwardStatus status) {
  return status == FeedForwardStatus::kOk ? "ok" : "bad_input";
}

JointModel::JointModel(int joints) : size(joints) {
  if (joints < 1 || joints > kMaxJoints)
    throw InputError(fmt::format("an arm: found {} joints, expected 1 to {}", joints, kMaxJoints));
  lag_s = inertia_s2 = droop = offset = compliance = JointVector::Zero(joints);
  scale = JointVector::Ones(joints);
  coupling = play = JointMatrix::Zero(joints, joints);
  turns.fill(true);
}

JointFeedForward::JointFeedForward(const JointModel& model, const FeedForwardOptions& options,
                                   const JointVector& start)
    : model_(model), options_(options), last_(start) {
  const int n = model.size;
  Check(model);
  Require(start, n, "start");
  options_.take_up_rate = OrUsual(options.take_up_rate, model, 2.0, 0.2, "take_up_rate");
  options_.max_rate = OrUsual(options.max_rate, model, 10.0, 1.0, "max_rate");
  options_.max_correction = OrUsual(options.max_correction, model, 0.5, 0.05, "max_correction");
  if (!(options.take_up_s > 0.0) || !(options.effort_memory_s > 0.0))
    throw InputError("feed-forward: take_up_s and effort_memory_s must be above 0");
  JointMatrix gains = model.coupling;
  gains.diagonal() = model.scale;
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(gains, Eigen::ComputeThinU | Eigen::ComputeThinV);
  if (svd.singularValues()[n - 1] < kSingular * svd.singularValues()[0])
    throw InputError("feed-forward: scale and coupling of the joints cannot be inverted");
  inverse_ = Eigen::MatrixXd(gains).inverse();
  turn_ahead_s_ = expected_ = lacking_ = effort_rate_ = JointVector::Zero(n);
  for (int j = 0; j < n; ++j) {
    // The middle of a crossing is half as fast again as its mean.
    const double rate = std::max(options_.take_up_rate[j], 1e-9);
    turn_ahead_s_[j] = 0.5 * std::max(options.take_up_s, 1.5 * std::abs(model.play(j, j)) / rate);
  }
}

bool JointFeedForward::IsUsable(const JointWish& wish, double dt_s) const {
  const auto usable = [&](const JointVector& x) {
    return x.size() == model_.size && x.allFinite() && x.cwiseAbs().maxCoeff() < kAbsurd;
  };
  return dt_s > 0.0 && dt_s < kLongest_s && usable(wish.q) && usable(wish.v) && usable(wish.a) &&
         (wish.v_ahead.size() == 0 || usable(wish.v_ahead));
}

/// What the model expects, and what the measured efforts have been telling that it lacks.
JointVector JointFeedForward::EffortOf(const JointWish& wish, double dt_s,
                                       const JointVector& measured) {
  JointVector expected = JointVector::Zero(model_.size);
  if (model_.effort) {
    const JointVector still = JointVector::Zero(model_.size);
    expected = model_.effort_at_rest ? model_.effort->Of(wish.q, still, still)
                                     : model_.effort->Of(wish.q, wish.v, wish.a);
  }
  if (!expected.allFinite()) expected = expected_;
  if (has_expected_) {
    const double part = std::min(1.0, dt_s / kEffortRate_s);
    effort_rate_ += part * ((expected - expected_) / dt_s - effort_rate_);
  }
  expected_ = expected;
  has_expected_ = true;
  if (measured.size() == model_.size && measured.allFinite() &&
      measured.cwiseAbs().maxCoeff() < kAbsurd) {
    const double part = std::min(1.0, dt_s / options_.effort_memory_s);
    lacking_ += part * (measured - expected - lacking_);
  }
  return expected + lacking_;
}

/// Moves every joint's state in its play on, to the side that its motion asks for.
void JointFeedForward::Cross(const JointWish& wish, double dt_s, bool& taking_up) {
  const JointVector& direction = wish.v_ahead.size() > 0 ? wish.v_ahead : wish.v;
  for (int j = 0; j < model_.size; ++j) {
    Crossing& crossing = crossings_[std::size_t(j)];
    crossing.rate = 0.0;
    if (model_.play(j, j) == 0.0) continue;
    const double still = model_.turns[std::size_t(j)] ? kStill_rad_s : kStill_m_s;
    if (std::abs(direction[j]) > still) {
      const double to = direction[j] > 0.0 ? -0.5 : 0.5;
      if (to != crossing.to) crossing = {crossing.state, to, 0.0, crossing.state, 0.0};
    }
    if (crossing.part >= 1.0) continue;
    const double by = 1.0 / (2.0 * turn_ahead_s_[j]), u = std::min(1.0, crossing.part + dt_s * by);
    const double way = crossing.to - crossing.from;
    crossing.part = u;
    crossing.state = crossing.from + way * u * u * (3.0 - 2.0 * u);
    crossing.rate = way * 6.0 * u * (1.0 - u) * by;
    taking_up = taking_up || u < 1.0;
  }
}

void JointFeedForward::Limit(const JointWish& wish, double dt_s, JointCommand& command) {
  for (int i = 0; i < model_.size; ++i) {
    const double correction = options_.max_correction[i], step = dt_s * options_.max_rate[i];
    const double near = std::clamp(command.q[i], wish.q[i] - correction, wish.q[i] + correction);
    command.correction_limited = command.correction_limited || near != command.q[i];
    const double slow = std::clamp(near, last_[i] - step, last_[i] + step);
    command.rate_limited = command.rate_limited || slow != near;
    command.q[i] = slow;
  }
}

JointCommand JointFeedForward::Step(const JointWish& wish, double dt_s,
                                    const JointVector& measured_effort) noexcept {
  JointCommand command;
  command.q = last_;
  if (!IsUsable(wish, dt_s)) return command;
  const JointVector effort = EffortOf(wish, dt_s, measured_effort);
  Cross(wish, dt_s, command.taking_up);
  JointVector states(model_.size), state_rates(model_.size);
  for (int j = 0; j < model_.size; ++j) {
    states[j] = crossings_[std::size_t(j)].state;
    state_rates[j] = crossings_[std::size_t(j)].rate;
  }
  JointVector behind = wish.q - model_.offset + model_.compliance.cwiseProduct(effort),
              behind_rate = wish.v + model_.compliance.cwiseProduct(effort_rate_);
  behind.noalias() -= model_.play * states;
  behind_rate.noalias() -= model_.play * state_rates;
  JointVector wanted(model_.size), wanted_rate(model_.size), wanted_more(model_.size);
  wanted.noalias() = inverse_ * behind;  // of the encoders
  wanted_rate.noalias() = inverse_ * behind_rate;
  wanted_more.noalias() = inverse_ * wish.a;
  command.q = wanted + model_.lag_s.cwiseProduct(wanted_rate) + model_.droop.cwiseProduct(effort) +
              model_.inertia_s2.cwiseProduct(wanted_more);
  if (!command.q.allFinite()) {
    command.q = last_;
    return command;
  }
  command.status = FeedForwardStatus::kOk;
  Limit(wish, dt_s, command);
  last_ = command.q;
  return command;
}

}  // namespace flextip
