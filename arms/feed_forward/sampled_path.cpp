#include "arms/feed_forward/sampled_path.h"

#include <fmt/format.h>

#include <algorithm>

#include "arms/data/smooth.h"
#include "arms/effects/late.h"
#include "core/error.h"

namespace flextip::arms {
namespace {

constexpr double kToStart_s = 0.9;  // that the arm has to come to the first command

}  // namespace

SampledPath::SampledPath(Track rows) : rows_(std::move(rows)) {
  if (rows_.Rows() < 5)
    throw InputError(fmt::format("a path of joints: {} rows, at least 5 are needed", rows_.Rows()));
  for (Eigen::Index k = 0; k < rows_.Rows(); ++k) {
    if (!rows_.values.row(k).allFinite() || (k > 0 && !(rows_.t_s[k] > rows_.t_s[k - 1]))) {
      throw InputError(fmt::format(
          "a path of joints: row {}: expected finite numbers and a time after the last", k + 1));
    }
  }
  Eigen::MatrixXd smooth;
  SmoothRates(rows_, smooth, rates_, accelerations_);
  slopes_.resize(rows_.Rows(), rows_.values.cols());
  for (Eigen::Index i = 0; i < rows_.values.cols(); ++i)
    slopes_.col(i) = Slopes(rows_.t_s, rows_.values.col(i));
}

bool SampledPath::IsWithin(double t_s) const {
  return t_s >= rows_.t_s[0] && t_s <= rows_.t_s[rows_.Rows() - 1];
}

JointVector SampledPath::Between(const Eigen::MatrixXd& values, double t_s) const {
  if (!IsWithin(t_s)) return JointVector::Zero(values.cols());
  const auto* begin = rows_.t_s.data();
  const auto after = std::upper_bound(begin, begin + rows_.Rows(), t_s) - begin;
  const Eigen::Index k = std::clamp<Eigen::Index>(after - 1, 0, rows_.Rows() - 2);
  const double u = (t_s - rows_.t_s[k]) / (rows_.t_s[k + 1] - rows_.t_s[k]);
  return ((1.0 - u) * values.row(k) + u * values.row(k + 1)).transpose();
}

JointVector SampledPath::JointsAt(double t_s) const {
  const Eigen::Index last = rows_.Rows() - 1;
  if (t_s <= rows_.t_s[0]) return rows_.values.row(0).transpose();
  if (t_s >= rows_.t_s[last]) return rows_.values.row(last).transpose();
  const auto* begin = rows_.t_s.data();
  const Eigen::Index k = std::upper_bound(begin, begin + last + 1, t_s) - begin - 1;
  const double h = rows_.t_s[k + 1] - rows_.t_s[k], u = (t_s - rows_.t_s[k]) / h, v = 1.0 - u;
  return (v * v * (1.0 + 2.0 * u) * rows_.values.row(k) + v * v * u * h * slopes_.row(k) +
          u * u * (1.0 + 2.0 * v) * rows_.values.row(k + 1) - u * u * v * h * slopes_.row(k + 1))
      .transpose();
}

JointVector SampledPath::RatesAt(double t_s) const { return Between(rates_, t_s); }

JointWish SampledPath::WishAt(double t_s, const JointFeedForward& feed_forward) const {
  const double at = t_s + feed_forward.Lead_s();
  JointWish wish{JointsAt(at), RatesAt(at), Between(accelerations_, at), {}};
  wish.v_ahead.resize(feed_forward.Size());
  for (int j = 0; j < feed_forward.Size(); ++j)
    wish.v_ahead[j] = RatesAt(at + feed_forward.TurnAhead_s()[j])[j];
  return wish;
}

PathCommands CommandsFor(const SampledPath& path, const JointModel& model,
                         const FeedForwardOptions& options) {
  const Track& rows = path.Rows();
  JointFeedForward feed_forward(model, options, rows.values.row(0).transpose());
  JointWish rest{path.JointsAt(rows.t_s[0]), JointVector::Zero(model.size),
                 JointVector::Zero(model.size), JointVector::Zero(model.size)};
  feed_forward.Step(rest, kToStart_s);  // from here on the rate counts
  PathCommands commands{.q = Eigen::MatrixXd(rows.Rows(), model.size)};
  for (Eigen::Index k = 0; k < rows.Rows(); ++k) {
    const double dt_s =
        rows.t_s[std::max<Eigen::Index>(k, 1)] - rows.t_s[std::max<Eigen::Index>(k, 1) - 1];
    const JointCommand command =
        feed_forward.Step(path.WishAt(rows.t_s[k], feed_forward), std::min(dt_s, kToStart_s));
    if (command.status != FeedForwardStatus::kOk) {
      throw InputError(
          fmt::format("a path of joints: row {}: joints or rates beyond what an arm "
                      "could be meant to do",
                      k + 1));
    }
    commands.q.row(k) = command.q.transpose();
    commands.rate_limited += command.rate_limited;
    commands.correction_limited += command.correction_limited;
    commands.taking_up += command.taking_up;
  }
  return commands;
}

}  // namespace flextip::arms
