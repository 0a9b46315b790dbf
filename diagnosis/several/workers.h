// Who works on the members: this process, and others that have read the same recordings.
#pragma once

#include <vector>

#include "diagnosis/several/helpers.h"
#include "diagnosis/several/member_work.h"

namespace flextip::diagnosis {

class MemberWorkers {
 public:
  explicit MemberWorkers(Fleet& fleet, const DiagnoseOptions& options = {},
                         const SelectionOptions& selection_options = {},
                         const Helpers& helpers = {});

  Fleet& Members() const { return fleet_; }
  const SelectionOptions& Options() const { return selection_options_; }

  /// Does the tasks, each in the process that has its member, and returns their answers in order.
  /// Throws WorkError as DoTask does, wherever it came from.
  std::vector<MemberAnswer> Do(const std::vector<MemberTask>& tasks) const;

  /// Does the tasks and takes where the members stand now; false where one has no equilibrium
  /// there: then some have moved.
  bool Move(const std::vector<MemberTask>& tasks) const;

 private:
  Fleet& fleet_;
  const DiagnoseOptions options_;
  const SelectionOptions selection_options_;
  Helpers helpers_;
};

}  // namespace flextip::diagnosis
