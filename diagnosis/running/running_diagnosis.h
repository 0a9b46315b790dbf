// The diagnosis while the instrument runs: which cause has set in, tested without end.
#pragma once

#include <array>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "diagnosis/running/information.h"
#include "diagnosis/running/onset_evidence.h"
#include "diagnosis/running/watched_parameters.h"
#include "diagnosis/running/watched_sample.h"
#include "estimation/watch/instrument_watch.h"

namespace flextip::diagnosis {

struct RunningOptions {
  double false_alarms_per_hour = 0.1;  ///< at most, by the model of what is within tolerance
  double port_prior_m = 0.0;           ///< of the port's registration, where above its tolerance
};

/// Weighs every watched cause at every second of the last twenty as its begin, and since the start,
/// against an instrument within tolerance. Constant cost per sample, no input or output; allocates
/// nothing once it is made.
class RunningDiagnosis : public InstrumentWatch {
 public:
  /// Takes instrument, port, gravity and tolerances from `base`.
  explicit RunningDiagnosis(const Recording& base, const RunningOptions& options = {});

  void Look(const WatchedMoment& moment) override;
  void Work() override;
  const FoundCause& Found() const override { return found_; }

  /// Returns the logarithm of the evidence of the last look, over that at which a cause is found.
  double LogEvidenceOverLimit() const { return log_evidence_ - log_limit_; }
  /// Returns how many samples have counted.
  long Samples() const { return samples_; }

 private:
  static constexpr int kBlocks = 20;
  /// A block of time.
  struct Block {
    running::Information sums;
    TimeNs first_ns = 0;
  };
  /// The work on the blocks, a step a cycle.
  enum class Step : std::uint8_t { kNothing, kAll, kOnsets, kSinceFound, kAtOnce, kDecide };

  bool IsDue(const WatchedMoment& moment);
  void Keep(const running::WatchedRows& rows);
  void CloseBlock(TimeNs t_ns);
  const Block& Newest(int back) const {
    return blocks_[static_cast<std::size_t>((newest_ - back + kBlocks) % kBlocks)];
  }
  void WeighAll(TimeNs since_ns, bool in_window);
  void Decide();
  bool IsDrift(int cause) const;
  void Name(double log_evidence);

  using Rows = running::WatchedRows;
  running::SampleWatch sample_;
  running::WatchedParameters parameters_;
  double log_limit_;
  long samples_ = 0;
  TimeNs looked_ns_ = 0, tip_ns_ = 0;
  std::array<TimeNs, 4> sampled_ns_{};
  // A reading that is apart from those on either side is left out: the last two samples wait.
  Rows rows_, pending_;
  Eigen::Matrix<double, running::kRows, 1> before_pending_;
  bool has_looked_ = false, has_waited_ = false;
  bool has_pending_ = false, has_before_ = false;

  running::Information growing_;
  TimeNs growing_from_ns_ = 0;
  std::vector<Block> blocks_;
  int newest_ = -1, count_ = 0;
  bool has_past_ = false;             // a block is not kept any more
  running::Information past_;         // before the blocks; fades
  running::Information since_found_;  // of it, what came after the found cause; fades alike
  running::Information all_, part_;
  running::Information most_part_;  // since the likeliest onset of all
  double most_log_ratio_ = 0.0, log_all_ = 0.0;
  std::array<running::Growth, running::kMostCauses> growths_;
  running::AllSamples weighing_;

  Step step_ = Step::kNothing;
  int onset_ = 0;
  struct Candidate {
    double log_evidence = -std::numeric_limits<double>::infinity();
    double best_log_ratio = -std::numeric_limits<double>::infinity();
    double beyond = 0.0;   // of its least size
    bool is_near = false;  // its size is one that a linear model can tell
    SizedCause sized;
    TimeNs since_ns = 0;
  };
  std::array<Candidate, running::kMostCauses> candidates_;
  double log_evidence_ = 0.0;
  TimeNs decided_ns_ = 0;
  FoundCause found_;
};

/// Returns the name of a cause of the watch's list, as in docs/effects.md.
std::string CauseName(int cause);
/// Returns a line in plain words: "the port yields more than the model says: 0.8 mm/N (sd 0.1)".
std::string Text(const FoundCause& found);

}  // namespace flextip::diagnosis
