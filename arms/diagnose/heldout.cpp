#include "arms/diagnose/heldout.h"

#include <algorithm>
#include <cmath>
#include <random>

#include "core/linear_algebra.h"

namespace flextip::arms {
namespace {

constexpr int kDraws = 200;

/// "rad" of "q1_rad".
std::string UnitPart(const std::string& component) {
  return component.substr(component.rfind('_') + 1);
}

diagnosis::NormalSums Train(const Problem& problem, int fold, int folds, int parts) {
  diagnosis::NormalSums sums(problem.total.g.size());
  for (const ProblemBlock& block : problem.blocks)
    if (block.place * folds / parts != fold) sums.Add(block.sums);
  return sums;
}

Eigen::MatrixXd Moved(const Channel& channel, const Eigen::VectorXd& step) {
  Eigen::MatrixXd residual = channel.residual;
  const Eigen::VectorXd by = channel.derivative * step;
  const Eigen::Index C = channel.Components();
  for (Eigen::Index k = 0; k < channel.Rows(); ++k)
    residual.row(k) -= by.segment(k * C, C).transpose();
  return residual;
}

}  // namespace

void ErrorSums::Add(const ErrorSums& other) {
  for (const auto& [name, sums] : other.by_name) {
    by_name[name].first += sums.first;
    by_name[name].second += sums.second;
  }
  weighted += other.weighted;
  count += other.count;
  tip += other.tip;
  tip_count += other.tip_count;
  tip_sum += other.tip_sum;
}

double ErrorSums::Rms(const std::string& name) const {
  const auto found = by_name.find(name);
  if (found == by_name.end() || found->second.second <= 0.0) return 0.0;
  return std::sqrt(found->second.first / found->second.second);
}

void AddErrors(const Replay& replay, std::size_t i, const ChannelNoise& noise,
               const Eigen::MatrixXd& residual, Eigen::Index from, Eigen::Index to,
               ErrorSums& sums) {
  const Channel& channel = replay.Channels()[i];
  const ArmData& data = replay.GetLayout().Recordings()[channel.recording];
  const std::string name = Name(channel.kind);
  const bool joints = channel.kind == Kind::kSeen || channel.kind == Kind::kFollowed;
  const Measured& measured = channel.kind == Kind::kSeen ? data.seen : data.followed;
  for (Eigen::Index k = from; k < to; ++k) {
    bool whole = true;
    for (Eigen::Index c = 0; c < channel.Components(); ++c) {
      if (!noise.keep(k, c)) {
        whole = false;
        continue;
      }
      const double e = residual(k, c);
      const auto add = [&](const std::string& key, double count) {
        sums.by_name[key].first += e * e;
        sums.by_name[key].second += count;
      };
      add(name + "_" + channel.components[c], 1.0);
      if (channel.kind == Kind::kPose) {
        add(c < 3 ? "pose0_position_m" : "pose0_orientation_rad", 1.0 / 3.0);
      } else {
        add(name + "_" + UnitPart(channel.components[c]), 1.0);
      }
      sums.weighted += std::pow(e / noise.floor[c], 2);
      sums.count += 1.0;
    }
    if (!whole || channel.kind == Kind::kTorque) continue;
    double tip = 0.0;
    if (joints) {
      const Eigen::VectorXd seen = measured.track.values.row(k).transpose();
      const Eigen::VectorXd predicted = seen - residual.row(k).transpose();
      const Pose T_LK = data.arm.T_LK.value_or(Pose{});
      tip = (data.nominal.Last(seen) * T_LK.p - data.nominal.Last(predicted) * T_LK.p).norm();
    } else {
      tip = residual.row(k).head<3>().norm();
    }
    sums.tip += tip * tip;
    sums.tip_sum += tip;
    sums.tip_count += 1.0;
  }
}

Eigen::VectorXd NuisancesOf(const diagnosis::NormalSums& sums, const Layout& layout) {
  Eigen::VectorXd theta = Eigen::VectorXd::Zero(layout.Size());
  std::vector<int> free;
  for (int b = layout.EffectCount(); b < int(layout.Blocks().size()); ++b)
    for (int j = 0; j < layout.Blocks()[b].size; ++j) free.push_back(layout.Blocks()[b].first + j);
  if (free.empty()) return theta;
  const Eigen::VectorXd sd = layout.Prior().Tolerances()(free);
  Eigen::MatrixXd M = sd.asDiagonal() * sums.H(free, free) * sd.asDiagonal();
  M.diagonal().array() += 1.0;
  theta(free) = sd.cwiseProduct(Llt(M).Solve(Eigen::VectorXd(sd.asDiagonal() * sums.g(free))));
  return theta;
}

ArmHeldOut MeasureHeldOut(const Replay& base, const Replay& extended, const Found& found,
                          const Problem& base_problem, int parts, int folds) {
  const Layout& layout = base.GetLayout();
  ArmHeldOut result;
  result.base_recordings.resize(layout.Recordings().size());
  result.extended_recordings.resize(layout.Recordings().size());
  std::vector<ErrorSums> base_parts, extended_parts;
  for (int fold = 0; fold < folds; ++fold) {
    const diagnosis::NormalSums train = Train(found.problem, fold, folds, parts);
    const diagnosis::Evidence evidence(train, layout.Prior(), found.generic_sd,
                                       {.scales = {0.3, 3.0}, .unknown_sd = {}});
    const auto& weighed = found.BestKnown().weighed;
    const Eigen::VectorXd step =
        evidence.Mode(weighed, evidence.Covariance(weighed)).head(layout.Size()) - extended.Theta();
    const Eigen::VectorXd base_step =
        NuisancesOf(Train(base_problem, fold, folds, parts), layout) - base.Theta();
    for (std::size_t i = 0; i < extended.Channels().size(); ++i) {
      const Channel& channel = extended.Channels()[i];
      const Eigen::MatrixXd with = Moved(channel, step),
                            without = Moved(base.Channels()[i], base_step);
      for (int part = 0; part < parts; ++part) {
        if (part * folds / parts != fold) continue;
        Eigen::Index from = 0, to = channel.Rows();
        while (from < to && PartOf(from, channel.Rows(), parts) < part) ++from;
        to = from;
        while (to < channel.Rows() && PartOf(to, channel.Rows(), parts) == part) ++to;
        ErrorSums b, e;
        AddErrors(base, i, found.noise[i], without, from, to, b);
        AddErrors(extended, i, found.noise[i], with, from, to, e);
        result.base_recordings[channel.recording].Add(b);
        result.extended_recordings[channel.recording].Add(e);
        base_parts.push_back(std::move(b));
        extended_parts.push_back(std::move(e));
      }
    }
  }
  for (const ErrorSums& sums : base_parts) result.base.Add(sums);
  for (const ErrorSums& sums : extended_parts) result.extended.Add(sums);
  std::mt19937_64 rng(7);
  std::uniform_int_distribution<std::size_t> draw(0, base_parts.size() - 1);
  std::vector<double> ratios;
  for (int i = 0; i < kDraws; ++i) {
    double b = 0.0, e = 0.0;
    for (std::size_t j = 0; j < base_parts.size(); ++j) {
      const std::size_t at = draw(rng);
      b += base_parts[at].weighted;
      e += extended_parts[at].weighted;
    }
    if (b > 0.0) ratios.push_back(std::sqrt(e / b));
  }
  std::sort(ratios.begin(), ratios.end());
  if (!ratios.empty()) {
    result.low = ratios[ratios.size() / 20];
    result.high = ratios[ratios.size() * 19 / 20];
  }
  return result;
}

}  // namespace flextip::arms
