// The ranks of an MPI job, which share the work on several recordings.
#pragma once

#include <tbb/global_control.h>

#include <functional>
#include <vector>

#include "batch/ranks.h"
#include "diagnosis/several/diagnose_several.h"

namespace flextip {

/// Whether mpirun started this process as one of several. Throws InputError where this program was
/// built without MPI.
bool RanksShareTheWork();

class RankHelpers {
 public:
  RankHelpers();
  /// On the first rank: lets the others go.
  ~RankHelpers();
  RankHelpers(const RankHelpers&) = delete;
  RankHelpers& operator=(const RankHelpers&) = delete;

  bool IsFirst() const;

  /// On the first rank: what DiagnoseSeveral asks the others by.
  diagnosis::Helpers Ask() const;
  /// On the others: works for the first one until that has its result. What is wrong with the
  /// recordings is told when there is something to do.
  void Serve(const diagnosis::DiagnoseOptions& options,
             const std::function<std::vector<diagnosis::NamedRecording>()>& read) const;

 private:
  batch::Ranks ranks_;
  tbb::global_control cores_;  // this rank's share of its machine
};

}  // namespace flextip
