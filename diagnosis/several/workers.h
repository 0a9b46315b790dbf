// Who works on the members: this process, and others that have read the same recordings.
#pragma once

#include <functional>
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

  /// Does a task of each member where the fit has it; where that has no equilibrium, at the place
  /// of its sums, which has one.
  using TaskAt = std::function<MemberTask::What(std::size_t member, Place place)>;
  std::vector<MemberAnswer> DoWhereTheyStand(const TaskAt& task) const;

  /// Takes where all members stand now.
  void Take(std::vector<MemberAnswer> answers) const;

 private:
  void Take(std::size_t r, MemberState state) const;

  Fleet& fleet_;
  const DiagnoseOptions options_;
  const SelectionOptions selection_options_;
  Helpers helpers_;
};

}  // namespace flextip::diagnosis
