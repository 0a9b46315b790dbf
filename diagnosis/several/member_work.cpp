#include "diagnosis/several/member_work.h"

#include <fmt/format.h>

#include <optional>
#include <utility>

#include "core/error.h"
#include "diagnosis/evidence/generic_basis.h"
#include "diagnosis/samples/noise_level.h"
#include "diagnosis/search/parameter_scan.h"
#include "diagnosis/several/reduced_sums.h"

namespace flextip::diagnosis {
namespace {

LinearProblem WholeProblem(const Replay& replay, const Member& member,
                           const SelectionOptions& options) {
  SelectionOptions whole = options;
  whole.blocks = 1;
  return ProblemHere(replay, member.basis, whole);
}

MemberState StateOf(const Replay& replay, const Member& member, const SelectionOptions& options) {
  const LinearProblem problem = WholeProblem(replay, member, options);
  return {PlaceOf(replay),
          OfParameters(problem, problem.total, GenericSd(problem, member.may_miss)),
          member.far_samples};
}

void LeaveOutFar(Replay& replay, Member& member) {
  const std::vector<std::size_t> far = FarSamples(replay);
  member.far_samples = int(far.size());
  replay.LeaveOut(far);
}

void Scan(Member& member, Replay& replay, const Fleet& fleet, bool shared_too) {
  std::vector<int> blocks = member.layout.ScannedBlocks();
  if (!shared_too) std::erase_if(blocks, [&](int b) { return !fleet.SharedOf(b).empty(); });
  ScanAgain(replay, member.layout, blocks, member.layout.Tolerances());
}

MemberState Do(const ToBase& task, Fleet& fleet, Member& member, const SelectionOptions& options) {
  SetScanCentres(member.layout, task.scan_centres);
  Replay replay(member.samples, member.layout);
  if (!replay.Evaluate(Eigen::VectorXd::Zero(member.layout.Size()))) {
    throw WorkError(fmt::format(
        "{}: the nominal instrument has no equilibrium in {} of {} samples: check length, port "
        "and load",
        member.name, replay.FailedSamples(), member.samples.samples.size()));
  }
  LeaveOutFar(replay, member);
  replay.FixNoiseModel();
  Scan(member, replay, fleet, task.scan_shared);
  member.settings = replay.SettingsNow();
  member.basis = GenericBasis(replay);
  const LinearProblem problem = WholeProblem(replay, member, options);
  member.may_miss = MayMiss(problem.residual_size, options.discrepancy, options);
  const Rows at_first = MayMiss(problem.residual_size, options.first_discrepancy, options);
  return {PlaceOf(replay), OfParameters(problem, problem.total, GenericSd(problem, at_first)),
          member.far_samples};
}

MemberAnswer Do(const Remeasure& task, Member& member, const SelectionOptions& options) {
  const auto replay = ReplayOf(member, task.place);
  if (!replay) return NoEquilibrium{};
  replay->LeaveOut({});
  LeaveOutFar(*replay, member);
  replay->SetNoiseScale(NoiseScale(*replay));
  replay->FixNoiseModel();
  member.settings = replay->SettingsNow();
  member.basis = GenericBasis(*replay);
  return StateOf(*replay, member, options);
}

template <class Answer>
MemberAnswer OrNone(std::optional<Answer> answer) {
  if (!answer) return NoEquilibrium{};
  return std::move(*answer);
}

}  // namespace

MemberAnswer DoTask(Fleet& fleet, const MemberTask& task, const DiagnoseOptions& options,
                    const SelectionOptions& selection_options) {
  Member& member = fleet.At(task.member);
  if (const auto* to_base = std::get_if<ToBase>(&task.what))
    return Do(*to_base, fleet, member, selection_options);
  if (const auto* to = std::get_if<ToPlace>(&task.what)) {
    const auto replay = ReplayOf(member, to->place);
    if (!replay) return NoEquilibrium{};
    return StateOf(*replay, member, selection_options);
  }
  if (const auto* again = std::get_if<Remeasure>(&task.what))
    return Do(*again, member, selection_options);
  if (const auto* sum = std::get_if<SumUp>(&task.what))
    return OrNone(SumMember(member, sum->place, sum->bags, task.member + 1, selection_options));
  const auto& judge = std::get<Judge>(task.what);
  return OrNone(JudgeMember(member, judge.place, judge.context, options, selection_options));
}

}  // namespace flextip::diagnosis
