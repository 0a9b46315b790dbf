#include "diagnosis/running/running_diagnosis.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "core/check.h"

namespace flextip::diagnosis {
namespace {

using running::kRows;

constexpr double kBlock_s = 1.0;
constexpr double kLeastPeriod_s = 0.05;  // between samples: more tell little more
constexpr double kTipGone_s = 1.0;       // without a tip, the other sensors are looked at alone
constexpr double kMemory_s = 60.0;       // of what came before the blocks
constexpr double kApart = 8.0;           // deviations of a reading from those on either side
constexpr double kAsWell = 20.0;         // a cause is named too where it is so little less likely
// All is linear about the model, which is off by some percent of what a cause explains. So a cause
// that explains nearly as much may be it, too; and what is larger than this is no linear size.
constexpr double kNearlyAsMuch = 0.9;
constexpr double kFarthest = 4.0;        // typical sizes
constexpr double kExplainsEnough = 0.5;  // of what the best size, or all causes at once, explain
constexpr int kOnsetsInStep = 2;
constexpr double kHour_s = 3600.0;

constexpr double kNone = -std::numeric_limits<double>::infinity();

double Seconds(TimeNs span_ns) { return 1e-9 * static_cast<double>(span_ns); }

/// Whether a row of `a` is far from that of `b`; both have unit noise.
bool IsApart(const Eigen::Matrix<double, kRows, 1>& a, const Eigen::Matrix<double, kRows, 1>& b) {
  return (a - b).cwiseAbs().maxCoeff() > kApart * std::sqrt(2.0);
}

}  // namespace

RunningDiagnosis::RunningDiagnosis(const Recording& base, const RunningOptions& options)
    : sample_(base),
      parameters_(sample_.Set(), options.port_prior_m),
      // The sum over the onsets grows by one a block on average while nothing has set in, so that
      // it gets above A within m blocks with a probability of at most m / A.
      log_limit_(std::log(kHour_s / kBlock_s / options.false_alarms_per_hour)),
      blocks_(kBlocks) {
  FLEXTIP_CHECK(options.false_alarms_per_hour > 0.0, "a rate of false alarms");
}

/// Whether the moment is a sample of its own: far enough from the last, with a tip where there are
/// tips.
bool RunningDiagnosis::IsDue(const WatchedMoment& moment) {
  const bool has_tip = moment.measurements.tip.has_value();
  if (has_tip) tip_ns_ = moment.t_ns;
  if (!has_tip && tip_ns_ != 0 && Seconds(moment.t_ns - tip_ns_) < kTipGone_s) return false;
  return looked_ns_ == 0 || Seconds(moment.t_ns - looked_ns_) >= kLeastPeriod_s;
}

void RunningDiagnosis::Look(const WatchedMoment& moment) {
  if (!moment.measurements.p_RW.allFinite() || !IsPlausible(moment.measurements)) return;
  if (!IsDue(moment)) return;
  looked_ns_ = moment.t_ns;
  has_looked_ = true;
  std::array<bool, 4> is_new{};
  for (std::size_t i = 0; i < is_new.size(); ++i) {
    is_new[i] = moment.sampled_ns[i] > sampled_ns_[i];
    sampled_ns_[i] = std::max(sampled_ns_[i], moment.sampled_ns[i]);
  }
  if (!sample_.Whiten(moment, is_new, parameters_, rows_)) {
    has_pending_ = has_before_ = false;
    return;
  }
  if (growing_from_ns_ == 0) growing_from_ns_ = moment.t_ns;
  Keep(rows_);
  if (Seconds(moment.t_ns - growing_from_ns_) >= kBlock_s && step_ == Step::kNothing)
    CloseBlock(moment.t_ns);
}

/// A reading that is far from the one before and the one after is left out.
void RunningDiagnosis::Keep(const Rows& rows) {
  if (has_pending_) {
    const bool wild =
        has_before_ && IsApart(pending_.e, before_pending_) && IsApart(pending_.e, rows.e);
    if (!wild) {
      growing_.Add(pending_);
      ++samples_;
    }
    before_pending_ = pending_.e;
    has_before_ = true;
  }
  pending_ = rows;
  has_pending_ = true;
}

void RunningDiagnosis::CloseBlock(TimeNs t_ns) {
  newest_ = (newest_ + 1) % kBlocks;
  Block& block = blocks_[static_cast<std::size_t>(newest_)];
  const double faded = std::exp(-Seconds(t_ns - growing_from_ns_) / kMemory_s);
  past_.Scale(faded);
  since_found_.Scale(faded);
  if (count_ == kBlocks) {
    past_.Add(block.sums);
    has_past_ = true;
    if (found_.IsThere() && block.first_ns >= found_.since_ns) since_found_.Add(block.sums);
  } else {
    ++count_;
  }
  block.sums = growing_;
  growing_.Clear();
  block.first_ns = growing_from_ns_;
  growing_from_ns_ = t_ns;
  decided_ns_ = t_ns;
  step_ = Step::kAll;
}

void RunningDiagnosis::Work() {
  // A sample is a cycle's share, where cycles are faster than samples.
  const bool waits = has_looked_ && !has_waited_;
  has_looked_ = false;
  has_waited_ = waits;
  if (waits) return;
  switch (step_) {
    case Step::kNothing:
      return;
    case Step::kAll:
      all_ = past_;
      for (int i = 0; i < count_; ++i) all_.Add(Newest(i).sums);
      weighing_.Take(all_);
      for (Candidate& candidate : candidates_) candidate = {};
      part_.Clear();
      growths_.fill({});
      most_log_ratio_ = log_all_ = kNone;
      onset_ = 0;
      step_ = Step::kOnsets;
      return;
    case Step::kOnsets:
      for (int i = 0; i < kOnsetsInStep && onset_ < count_; ++i, ++onset_) {
        for (std::size_t k = 0; k < parameters_.Blocks().size(); ++k) {
          const auto& watched = parameters_.Blocks()[k];
          if (watched.drifts) growths_[k].TakeOlder(part_, Newest(onset_).sums, watched.first);
        }
        part_.Add(Newest(onset_).sums);
        // Nothing came before the oldest one: it is the start, below.
        if (has_past_ || onset_ + 1 < count_) WeighAll(Newest(onset_).first_ns, true);
      }
      if (onset_ == count_) step_ = Step::kSinceFound;
      return;
    case Step::kSinceFound: {
      // All samples: it was there from the start. Or, once found, since then.
      const bool since = found_.IsThere() && found_.since_ns > 0;
      if (since && Newest(count_ - 1).first_ns > found_.since_ns) {
        part_.Add(since_found_);
        WeighAll(found_.since_ns, false);
      } else if (!since) {
        part_ = all_;
        WeighAll(0, false);
      }
      step_ = Step::kAtOnce;
      return;
    }
    case Step::kAtOnce:
      weighing_.Since(most_part_);
      log_all_ = weighing_.OfAll(parameters_);
      step_ = Step::kDecide;
      return;
    case Step::kDecide:
      Decide();
      step_ = Step::kNothing;
      return;
  }
}

void RunningDiagnosis::WeighAll(TimeNs since_ns, bool in_window) {
  weighing_.Since(part_);
  const auto& watched = parameters_.Blocks();
  for (std::size_t i = 0; i < watched.size(); ++i) {
    if (watched[i].widened == 0 || (watched[i].drifts && !in_window)) continue;
    const running::OnsetEvidence evidence = watched[i].drifts
                                                ? weighing_.Of(watched[i], parameters_, growths_[i])
                                                : weighing_.Of(watched[i], parameters_);
    if (evidence.log_ratio > most_log_ratio_) {
      most_log_ratio_ = evidence.log_ratio;
      most_part_ = part_;
    }
    Candidate& candidate = candidates_[i];
    candidate.log_evidence = running::AddLogarithms(candidate.log_evidence, evidence.log_ratio);
    if (evidence.log_ratio <= candidate.best_log_ratio) continue;
    candidate.best_log_ratio = evidence.log_ratio;
    candidate.sized = {static_cast<std::int8_t>(i), evidence.value, evidence.sd};
    candidate.since_ns = since_ns;
    candidate.beyond = evidence.beyond / watched[i].least;
    candidate.is_near = evidence.farthest < kFarthest;
  }
}

void RunningDiagnosis::Decide() {
  double sum = kNone;
  int causes = 0;
  for (const auto& watched : parameters_.Blocks()) causes += watched.widened > 0;
  for (const Candidate& candidate : candidates_)
    sum = running::AddLogarithms(sum, candidate.log_evidence);
  // The block in which a cause sets in is half without it: no onset fits, and a wrong name may fit
  // best. So the next block must say so, too.
  const bool was_above = log_evidence_ >= log_limit_;
  log_evidence_ = sum - std::log(static_cast<double>(causes));
  if (found_.IsThere() || (was_above && log_evidence_ >= log_limit_)) Name(log_evidence_);
}

bool RunningDiagnosis::IsDrift(int cause) const {
  return cause != kUnknownCause && parameters_.Blocks()[static_cast<std::size_t>(cause)].drifts;
}

/// Takes the likeliest cause whose size is one. One that was named before stays until another is
/// far likelier.
void RunningDiagnosis::Name(double log_evidence) {
  const Candidate* best = nullptr;
  double most = kNone;
  for (const Candidate& candidate : candidates_) {
    most = std::max(most, candidate.log_evidence);
    if (!candidate.is_near) continue;
    if (best == nullptr || candidate.log_evidence > best->log_evidence) best = &candidate;
  }
  const bool is_known = best != nullptr && best->log_evidence >= kExplainsEnough * most &&
                        best->best_log_ratio >= kExplainsEnough * log_all_;
  FoundCause now = found_;
  // A drift is told by its begin: once that is too long ago, its name stays.
  const bool is_old = found_.IsThere() && found_.since_ns < Newest(count_ - 1).first_ns;
  if (is_old && IsDrift(found_.likeliest.cause)) return;
  now.log_evidence = log_evidence;
  now.other = {};
  now.has_more = false;
  if (!is_known) {
    now.likeliest = {static_cast<std::int8_t>(kUnknownCause), 0.0, 0.0};
  } else {
    const double as_well =
        std::min(best->log_evidence - std::log(kAsWell), kNearlyAsMuch * best->log_evidence);
    const std::int8_t named = found_.likeliest.cause;
    if (found_.IsThere() && named != kUnknownCause) {
      const Candidate& before = candidates_[static_cast<std::uint8_t>(named)];
      if (before.is_near && before.log_evidence >= best->log_evidence - std::log(kAsWell))
        best = &before;
    }
    now.likeliest = best->sized;
    double second = kNone;
    for (const Candidate& candidate : candidates_) {
      if (&candidate == best || !candidate.is_near || candidate.log_evidence < as_well) continue;
      now.has_more |= now.other.cause >= 0;
      if (candidate.log_evidence <= second) continue;
      second = candidate.log_evidence;
      now.other = candidate.sized;
    }
  }
  if (!found_.IsThere()) {
    // What is within tolerance is no cause, however sure.
    if (is_known && best->beyond < 1.0) return;
    now.found_ns = decided_ns_;
    now.since_ns = best != nullptr ? best->since_ns : decided_ns_;
  }
  found_ = now;
}

}  // namespace flextip::diagnosis
