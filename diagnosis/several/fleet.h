// Several recordings of one instrument: their samples, and which parameters they share.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "diagnosis/diagnose.h"
#include "diagnosis/search/hypothesis_fit.h"
#include "diagnosis/several/diagnose_several.h"

namespace flextip::diagnosis {

/// One of the recordings, where the search has it. A replay is made when it is needed: of a hundred
/// recordings not all fit in memory.
struct Member {
  std::string name;
  SampleSet samples;
  ParameterLayout layout;  ///< the effects' blocks are the same for all; nuisances may differ
  Replay::Settings settings = {};
  Eigen::MatrixXd basis = {};  ///< of the generic terms
  Rows may_miss = Rows::Zero();
  Place place = {};
  /// About the place, of the layout's parameters: the generic terms are integrated out.
  NormalSums sums;
  /// Where the fit has the parameters: at the place, or so near that the sums still hold.
  Eigen::VectorXd theta = {};
  int far_samples = 0;

  Member(std::string its_name, SampleSet its_samples, const std::vector<std::string>& effects,
         const EffectMakers& own);
  Member(const Member&) = delete;
  Member& operator=(const Member&) = delete;
};

class Fleet {
 public:
  /// All know the effects that one of them could show. Throws InputError where one cannot be judged
  /// (sample_set.h), and where they are not of one instrument: the line names both and what
  /// differs.
  Fleet(const std::vector<NamedRecording>& recordings, const DiagnoseOptions& options);

  std::size_t Size() const { return members_.size(); }
  Member& At(std::size_t r) { return *members_[r]; }
  const Member& At(std::size_t r) const { return *members_[r]; }
  const ParameterLayout& Layout() const { return members_.front()->layout; }
  int EffectCount() const { return Layout().EffectCount(); }

  /// Indices of the parameters that all share.
  const std::vector<int>& Shared() const { return shared_; }
  /// The places among the shared ones of what effect `e` shares; its own parameters' indices.
  const std::vector<int>& SharedOf(int e) const { return shared_of_[e]; }
  const std::vector<int>& OwnOf(int e) const { return own_of_[e]; }

 private:
  std::vector<std::unique_ptr<Member>> members_;
  std::vector<int> shared_;
  std::vector<std::vector<int>> shared_of_, own_of_;
};

/// Returns the place of a member with the parameters that the fit has.
Place PlaceNow(const Member& member);

/// Returns the replay of a member at its place, or at other parameters from there; empty where that
/// has no equilibrium.
std::unique_ptr<Replay> ReplayOf(Member& member, const Place& place);

}  // namespace flextip::diagnosis
