#include "arms/diagnose/search.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "core/linear_algebra.h"

namespace flextip::arms {
namespace {

using diagnosis::Evidence;
using diagnosis::EvidenceOptions;
using diagnosis::Hypothesis;
using diagnosis::WeighedHypothesis;

constexpr double kRival = 3.0;          // log odds below the best that are worth a fit
constexpr double kMuchLeft = 4.0;       // chi-squared per row, in stated noise
constexpr double kHardlyCounts = 0.02;  // of what is left
constexpr int kMostDrops = 3;
constexpr double kWorthCarrying = 20.0;  // squared residual
constexpr int kMostFits = 14;            // a round
constexpr int kFitRounds = 6;
constexpr int kNoiseRounds = 3;
// Widths of a window that are tried, in rad or 10 cm.
constexpr double kWidths[] = {0.0,  0.002, 0.004, 0.008, 0.015, 0.025, 0.04,
                              0.06, 0.09,  0.13,  0.18,  0.25,  0.35,  0.5};

const std::vector<double> kScales{0.3, 3.0};

/// Where a hypothesis fits.
struct Place {
  Hypothesis hypothesis;
  Eigen::VectorXd theta, windows;
  double log_posterior = -1e300;
};

class Searcher {
 public:
  Searcher(Replay& replay, Layout& layout, const SearchOptions& options)
      : replay_(replay), layout_(layout), options_(options) {}

  Found Run() {
    SetWindows(Eigen::VectorXd());
    replay_.Evaluate(Eigen::VectorXd::Zero(layout_.Size()));
    replay_.Register();
    replay_.Evaluate(Eigen::VectorXd::Zero(layout_.Size()));
    noise_ = MeasureNoise(replay_, false);
    FitNuisances(replay_, noise_);
    found_.base_theta = replay_.Theta();
    noise_ = MeasureNoise(replay_, false);
    basis_.emplace(replay_);
    sizes_ = SizesOf(replay_, noise_);
    generic_sd_ = Eigen::VectorXd::Constant(GenericCount(replay_, *basis_), options_.discrepancy);
    FitAll();
    Hypothesis last;
    for (int round = 0; round < kNoiseRounds; ++round) {
      tried_.clear();
      Round();
      GoTo(best_);
      const Noise now = MeasureNoise(replay_, true);
      const bool same = round > 0 && best_.hypothesis == last;
      last = best_.hypothesis;
      noise_ = now;
      found_.converged = same;
      if (same) break;
    }
    for (int round = 0; round < kMostDrops && ForbidWhatHardlyCounts(); ++round) {
      tried_.clear();
      Round();
      GoTo(best_);
      noise_ = MeasureNoise(replay_, true);
    }
    Finish();
    return std::move(found_);
  }

 private:
  Evidence EvidenceHere(const Problem& problem, bool unknown) const {
    EvidenceOptions own{.scales = kScales, .unknown_sd = {}};
    if (unknown) own.unknown_sd = {0.1, 0.3, 1.0};
    return Evidence(problem.total, layout_.Prior(), generic_sd_, own);
  }
  Problem ProblemHere() const {
    return MakeProblem(replay_, noise_, *basis_, sizes_, options_.parts);
  }

  void SetWindows(const Eigen::VectorXd& windows) {
    if (layout_.WindowBlock() >= 0)
      layout_.Blocks()[layout_.WindowBlock()].effect->SetWindows(windows);
  }
  Eigen::VectorXd Windows() const {
    return layout_.WindowBlock() < 0 ? Eigen::VectorXd()
                                     : layout_.Blocks()[layout_.WindowBlock()].effect->Windows();
  }
  void GoTo(const Place& place) {
    SetWindows(place.windows);
    replay_.Evaluate(place.theta);
  }

  /// Everything at once, for the noise that no answer could take away.
  void FitAll() {
    Hypothesis all;
    for (int b = 0; b < layout_.EffectCount(); ++b) all.effects.push_back(b);
    // What the base leaves is no noise: the first fit takes it as stated.
    for (ChannelNoise& noise : noise_) noise.sd = noise.floor;
    for (int round = 0; round < 2; ++round) {
      Descend(all, 3);
      if (layout_.WindowBlock() >= 0) ScanWindows();
      Descend(all, 2);
      noise_ = MeasureNoise(replay_, true);
    }
    best_ = {all, replay_.Theta(), Windows(), -1e300};
  }

  /// Moves the replay to where `hypothesis` fits.
  WeighedHypothesis Descend(const Hypothesis& hypothesis, int rounds) {
    WeighedHypothesis weighed{hypothesis, 0.0, std::vector<double>(hypothesis.effects.size(), 3.0),
                              0.0};
    for (int round = 0; round < rounds; ++round) {
      const Problem problem = ProblemHere();
      const Evidence evidence = EvidenceHere(problem, false);
      if (hypothesis.effects.size() <= std::size_t(options_.most_effects))
        weighed = evidence.Weigh(hypothesis);
      const Eigen::MatrixXd covariance = evidence.Covariance(weighed);
      const Eigen::VectorXd mode = evidence.Mode(weighed, covariance).head(layout_.Size());
      const Eigen::VectorXd step = mode - replay_.Theta();
      const Eigen::VectorXd sd =
          covariance.diagonal().head(layout_.Size()).cwiseMax(1e-300).cwiseSqrt();
      replay_.Evaluate(mode);
      if (step.cwiseQuotient(sd).norm() < 0.1) break;
    }
    return weighed;
  }

  /// The window of each joint's play by what its state explains, joint by joint.
  void ScanWindows() {
    const Layout::Block& block = layout_.Blocks()[layout_.WindowBlock()];
    const ArmData& data = layout_.DataOf(block);
    const int n = data.Size();
    Eigen::VectorXd windows = Windows();
    if (windows.size() < n) windows = Eigen::VectorXd::Zero(n);
    for (int j = 0; j < n; ++j) {
      if (!Moves(j)) continue;
      std::vector<int> columns;
      for (const int own : block.effect->OfWindow(data, j)) columns.push_back(block.first + own);
      const double range = Range(j);
      const double unit = data.TypicalOf(j, 1.0, 0.1);
      double best = 0.0, best_width = windows[j];
      const auto tell = [&](double width) {
        windows[j] = width;
        SetWindows(windows);
        Eigen::VectorXd theta = replay_.Theta();
        const double gain = Explained(theta, columns);
        if (gain <= best) return;
        best = gain;
        best_width = width;
      };
      const Eigen::VectorXd theta = replay_.Theta();
      for (const double width : kWidths)
        if (width * unit < 0.7 * range || width == 0.0) tell(width * unit);
      for (const double by : {0.8, 0.9, 1.12, 1.25})
        if (best_width > 0.0) tell(best_width * by);
      windows[j] = best_width;
      SetWindows(windows);
      replay_.Evaluate(theta);
    }
  }

  bool Moves(int joint) const { return Range(joint) > 1e-4; }

  /// Lets what is dragged pass through the play of what it drags, where that explains more.
  void TryCarrying() {
    const Layout::Block& block = layout_.Blocks()[layout_.WindowBlock()];
    const ArmData& data = layout_.DataOf(block);
    const Eigen::VectorXd theta = replay_.Theta(), before = Windows();
    std::vector<int> columns;
    for (int j = 0; j < data.Size(); ++j)
      for (const int own : block.effect->OfWindow(data, j))
        if (Moves(j)) columns.push_back(block.first + own);
    if (columns.empty()) return;
    const double plain = Explained(theta, columns);
    SetWindows(block.effect->Carrying(data, theta.segment(block.first, block.size)));
    const double carried = Explained(theta, columns);
    if (carried < plain + kWorthCarrying) SetWindows(before);
    replay_.Evaluate(theta);
  }

  double Range(int joint) const {
    double range = 0.0;
    for (const ArmData& data : layout_.Recordings()) {
      const auto q = data.joints.values.col(joint);
      range = std::max(range, q.maxCoeff() - q.minCoeff());
    }
    return range;
  }

  /// How much of the squared residual `columns` take with them, of what stays without them.
  double Explained(const Eigen::VectorXd& at, const std::vector<int>& columns) {
    Eigen::VectorXd theta = at;
    for (const int c : columns) theta[c] = 0.0;
    replay_.Evaluate(theta);
    const auto size = Eigen::Index(columns.size());
    Eigen::MatrixXd H = Eigen::MatrixXd::Zero(size, size);
    Eigen::VectorXd g = Eigen::VectorXd::Zero(size);
    for (std::size_t i = 0; i < noise_.size(); ++i) {
      const Channel& channel = replay_.Channels()[i];
      const Eigen::Index C = channel.Components();
      if (channel.kind != Kind::kSeen && channel.kind != Kind::kPose) continue;
      for (Eigen::Index k = 0; k < channel.Rows(); ++k)
        for (Eigen::Index c = 0; c < C; ++c) {
          if (!noise_[i].keep(k, c)) continue;
          const double by = 1.0 / noise_[i].sd[c];
          Eigen::VectorXd row(size);
          for (Eigen::Index a = 0; a < size; ++a)
            row[a] = by * channel.derivative(k * C + c, columns[a]);
          H.noalias() += row * row.transpose();
          g.noalias() += by * channel.residual(k, c) * row;
        }
    }
    for (Eigen::Index a = 0; a < size; ++a) {
      const auto& p = layout_.Prior().Parameter(columns[a]);
      H(a, a) += 1.0 / (9.0 * p.typical * p.typical);
    }
    return g.dot(Llt(H).Solve(g));
  }

  const Place* Tried(const Hypothesis& hypothesis) const {
    for (const Place& place : tried_)
      if (place.hypothesis == hypothesis) return &place;
    return nullptr;
  }

  /// Fits a hypothesis from where the best is, and keeps where that leads.
  void Fit(const Hypothesis& hypothesis, const Place& from) {
    GoTo(from);
    const bool window = layout_.WindowBlock() >= 0 &&
                        std::find(hypothesis.effects.begin(), hypothesis.effects.end(),
                                  layout_.WindowBlock()) != hypothesis.effects.end();
    Descend(hypothesis, window ? 2 : kFitRounds);
    if (window) {
      ScanWindows();
      Descend(hypothesis, 2);
      for (int round = 0; round < 2; ++round) {
        TryCarrying();
        ScanWindows();
        Descend(hypothesis, 2);
      }
      Descend(hypothesis, kFitRounds);
    }
    const Problem problem = ProblemHere();
    const Evidence evidence = EvidenceHere(problem, false);
    Place place{hypothesis, replay_.Theta(), Windows(),
                evidence.LogEvidenceOfNone() + evidence.Weigh(hypothesis).log_evidence +
                    LogPriorOf(hypothesis, layout_.EffectCount(), options_)};
    ++found_.fits;
    tried_.push_back(place);
    if (place.log_posterior > best_.log_posterior) best_ = place;
  }

  /// Whether two of its effects are the same in one recording.
  bool Repeats(const Hypothesis& hypothesis) const {
    for (std::size_t i = 0; i < hypothesis.effects.size(); ++i)
      for (std::size_t j = i + 1; j < hypothesis.effects.size(); ++j) {
        const auto& a = layout_.Blocks()[hypothesis.effects[i]];
        const auto& b = layout_.Blocks()[hypothesis.effects[j]];
        if (a.effect->Name() != b.effect->Name()) continue;
        if (!a.change && !b.change) return true;
        if (a.change && b.change && a.effect->ComesAndGoes() && a.in == b.in) return true;
      }
    return false;
  }

  std::vector<Scored> ScoreHere(const Evidence& evidence, bool unknown) const {
    std::vector<Scored> all;
    std::set<std::vector<int>> seen;
    const auto weigh = [&](const std::vector<Hypothesis>& hypotheses) {
      std::vector<Scored> scored(hypotheses.size());
      tbb::parallel_for(std::size_t{0}, hypotheses.size(), [&](std::size_t i) {
        scored[i].weighed = evidence.Weigh(hypotheses[i]);
        scored[i].log_posterior = scored[i].weighed.log_evidence +
                                  LogPriorOf(hypotheses[i], layout_.EffectCount(), options_);
      });
      std::stable_sort(scored.begin(), scored.end(), Better);
      all.insert(all.end(), scored.begin(), scored.end());
      return scored;
    };
    std::vector<Hypothesis> frontier{{}};
    if (unknown) weigh({Hypothesis{{}, true}});
    weigh(frontier);
    double best = all.front().log_posterior;
    for (int size = 1; size <= options_.most_effects; ++size) {
      std::vector<Hypothesis> next;
      for (const Hypothesis& h : frontier)
        for (int b = 0; b < layout_.EffectCount(); ++b) {
          if (forbidden_.contains(b)) continue;
          if (std::find(h.effects.begin(), h.effects.end(), b) != h.effects.end()) continue;
          Hypothesis longer = h;
          longer.effects.push_back(b);
          std::sort(longer.effects.begin(), longer.effects.end());
          if (Repeats(longer) || !seen.insert(longer.effects).second) continue;
          next.push_back(longer);
        }
      if (next.empty()) break;
      const auto scored = weigh(next);
      frontier.clear();
      // Pairs may show what neither shows alone: all singles are extended.
      const std::size_t keep = size == 1 ? scored.size() : std::size_t(options_.beam);
      for (std::size_t i = 0; i < scored.size() && i < keep; ++i)
        frontier.push_back(scored[i].weighed.hypothesis);
      if (size > 2 && scored.front().log_posterior < best - 12.0) break;
      best = std::max(best, scored.front().log_posterior);
    }
    std::stable_sort(all.begin(), all.end(), Better);
    return all;
  }

  static bool Better(const Scored& a, const Scored& b) { return a.log_posterior > b.log_posterior; }

  /// With the noise as it is: fits what looks likely until nothing unfitted looks better.
  void Round() {
    Place from = best_;
    best_.log_posterior = -1e300;
    for (int fits = 0; fits < kMostFits;) {
      GoTo(from);
      const Problem problem = ProblemHere();
      const Evidence evidence = EvidenceHere(problem, false);
      const double none = evidence.LogEvidenceOfNone();
      const auto scored = ScoreHere(evidence, false);
      int fitted = 0;
      for (const Scored& s : scored) {
        if (fitted >= 3 || s.log_posterior + none < best_.log_posterior - kRival) break;
        if (Tried(s.weighed.hypothesis) != nullptr) continue;
        if (fitted > 0 && s.log_posterior < scored.front().log_posterior - kRival) break;
        Fit(s.weighed.hypothesis, from);
        ++fitted;
        ++fits;
      }
      if (fitted == 0) return;
      from = best_;
    }
  }

  /// Squared misfit in stated noise, with the parameters moved by `step` as the derivatives say.
  double MisfitAfter(const Eigen::VectorXd& step) const {
    double sum = 0.0;
    for (std::size_t i = 0; i < noise_.size(); ++i) {
      const Channel& channel = replay_.Channels()[i];
      const Eigen::VectorXd by = channel.derivative * step;
      const Eigen::Index C = channel.Components();
      for (Eigen::Index k = 0; k < channel.Rows(); ++k)
        for (Eigen::Index c = 0; c < C; ++c)
          if (noise_[i].keep(k, c))
            sum += std::pow((channel.residual(k, c) - by[k * C + c]) / noise_[i].floor[c], 2);
    }
    return sum;
  }

  /// By how much of what is left the misfit rises without each effect of the best, with all that
  /// recordings have of it.
  std::vector<double> Importance() {
    GoTo(best_);
    const Problem problem = ProblemHere();
    const Evidence evidence = EvidenceHere(problem, false);
    const double left = MisfitAfter(Eigen::VectorXd::Zero(layout_.Size()));
    std::vector<double> importance;
    for (const int effect : best_.hypothesis.effects) {
      Hypothesis without;
      const std::string name = layout_.Blocks()[effect].effect->Name();
      for (const int other : best_.hypothesis.effects)
        if (layout_.Blocks()[other].effect->Name() != name) without.effects.push_back(other);
      const WeighedHypothesis weighed = evidence.Weigh(without);
      const Eigen::VectorXd mode =
          evidence.Mode(weighed, evidence.Covariance(weighed)).head(layout_.Size());
      importance.push_back(MisfitAfter(mode - replay_.Theta()) / std::max(1e-300, left) - 1.0);
    }
    long count = 0;
    for (const ChannelNoise& noise : noise_) count += noise.keep.count();
    left_per_row_ = left / double(std::max(1L, count));
    return importance;
  }

  /// Whether the best has the same effect in other recordings: one may take up the other.
  bool HasTwin(int effect) const {
    const std::string name = layout_.Blocks()[effect].effect->Name();
    return std::any_of(best_.hypothesis.effects.begin(), best_.hypothesis.effects.end(),
                       [&](int other) {
                         return other != effect && layout_.Blocks()[other].effect->Name() == name;
                       });
  }

  /// Where much is left that nothing explains, an effect that takes away a hundredth of it is not
  /// claimed: any smooth form would. Returns whether there was one.
  bool ForbidWhatHardlyCounts() {
    // What hangs on a link or drives a joint has a form of its own; places of joints do not.
    for (const Channel& channel : replay_.Channels())
      if (channel.kind == Kind::kTorque || channel.kind == Kind::kFollowed) return false;
    const std::vector<double> importance = Importance();
    if (left_per_row_ < kMuchLeft) return false;
    int least = -1;
    for (int i = 0; i < int(importance.size()); ++i)
      if (importance[i] < kHardlyCounts && !HasTwin(best_.hypothesis.effects[i]) &&
          (least < 0 || importance[i] < importance[least]))
        least = i;
    if (least < 0) return false;
    const int block = best_.hypothesis.effects[least];
    forbidden_.insert(block);
    found_.not_claimed.push_back(block);
    std::erase(best_.hypothesis.effects, block);
    return true;
  }

  void Finish() {
    found_.importance.clear();
    const std::vector<double> importance = Importance();
    for (std::size_t i = 0; i < importance.size(); ++i)
      found_.importance[best_.hypothesis.effects[i]] = importance[i];
    GoTo(best_);
    found_.problem = ProblemHere();
    const Evidence evidence = EvidenceHere(found_.problem, true);
    found_.scored = ScoreHere(evidence, true);
    // What own fits said beyond the linear problem, less what that promised to the best.
    const auto linear = [&](const Hypothesis& hypothesis) {
      for (const Scored& s : found_.scored)
        if (s.weighed.hypothesis == hypothesis) return s.log_posterior;
      return -1e300;
    };
    const double best_linear = linear(best_.hypothesis);
    for (Scored& s : found_.scored) {
      const Place* tried = Tried(s.weighed.hypothesis);
      if (tried == nullptr || s.weighed.hypothesis == best_.hypothesis) continue;
      const double own = tried->log_posterior - best_.log_posterior;
      s.correction = std::min(0.0, own) - (s.log_posterior - best_linear);
      // An own fit that found more than the linear problem promised counts, one that found less
      // too.
      s.log_posterior += s.correction;
    }
    std::stable_sort(found_.scored.begin(), found_.scored.end(), Better);
    found_.generic_sd = generic_sd_;
    found_.noise = noise_;
    found_.sizes = sizes_;
  }

  Replay& replay_;
  Layout& layout_;
  const SearchOptions& options_;
  std::optional<Basis> basis_;
  Noise noise_;
  std::vector<Eigen::VectorXd> sizes_;
  Eigen::VectorXd generic_sd_;
  std::vector<Place> tried_;
  Place best_;
  std::set<int> forbidden_;
  double left_per_row_ = 0.0;
  Found found_;
};

}  // namespace

Found Search(Replay& replay, Layout& layout, const SearchOptions& options) {
  return Searcher(replay, layout, options).Run();
}

double LogPriorOf(const Hypothesis& hypothesis, int effects, const SearchOptions& options) {
  const double n = std::max(1, effects);
  if (hypothesis.unknown) return std::log(options.prior_unknown);
  const std::size_t size = hypothesis.effects.size();
  if (size == 0) return std::log(options.prior_none);
  double log_count = 0.0;  // of choices of so many
  for (std::size_t i = 0; i < size; ++i)
    log_count += std::log(std::max(1.0, n - double(i)) / double(i + 1));
  if (size == 1) return std::log(options.prior_single) - log_count;
  return std::log(options.prior_pair) + double(size - 2) * std::log(options.prior_more) - log_count;
}

const Scored& Found::BestKnown() const {
  for (const Scored& s : scored)
    if (!s.weighed.hypothesis.unknown) return s;
  return scored.front();
}

namespace {

/// The parameters with those of `free` where they fit, about where the replay is.
Eigen::VectorXd FitSome(const Replay& replay, const Noise& noise, const std::vector<int>& free) {
  const auto size = Eigen::Index(free.size());
  const Eigen::VectorXd sd = replay.GetLayout().Prior().Tolerances()(free);
  Eigen::MatrixXd H = Eigen::MatrixXd::Identity(size, size);
  Eigen::VectorXd g = Eigen::VectorXd::Zero(size);
  for (std::size_t i = 0; i < noise.size(); ++i) {
    const Channel& channel = replay.Channels()[i];
    const Eigen::Index C = channel.Components();
    const Eigen::MatrixXd X = channel.derivative(Eigen::all, free) * sd.asDiagonal();
    for (Eigen::Index k = 0; k < channel.Rows(); ++k)
      for (Eigen::Index c = 0; c < C; ++c) {
        if (!noise[i].keep(k, c)) continue;
        const double by = 1.0 / noise[i].sd[c];
        const Eigen::VectorXd row = by * X.row(k * C + c).transpose();
        const double z =
            by * channel.residual(k, c) + row.dot(replay.Theta()(free).cwiseQuotient(sd));
        H.noalias() += row * row.transpose();
        g.noalias() += z * row;
      }
  }
  Eigen::VectorXd theta = replay.Theta();
  theta(free) = sd.cwiseProduct(Llt(H).Solve(g));
  return theta;
}

std::vector<int> Nuisances(const Layout& layout, bool own_alone) {
  std::vector<int> free;
  for (int b = layout.EffectCount(); b < int(layout.Blocks().size()); ++b) {
    const Layout::Block& block = layout.Blocks()[b];
    for (int j = 0; j < block.size; ++j)
      if (!own_alone || block.effect->OwnInEach()) free.push_back(block.first + j);
  }
  return free;
}

}  // namespace

void FitNuisances(Replay& replay, const Noise& noise, int rounds) {
  const std::vector<int> free = Nuisances(replay.GetLayout(), false);
  for (int round = 0; round < rounds && !free.empty(); ++round)
    replay.Evaluate(FitSome(replay, noise, free));
}

Eigen::VectorXd FitOwn(const Replay& replay, const Noise& noise) {
  const std::vector<int> free = Nuisances(replay.GetLayout(), true);
  return free.empty() ? replay.Theta() : FitSome(replay, noise, free);
}

}  // namespace flextip::arms
