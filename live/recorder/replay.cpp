#include "live/recorder/replay.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

#include "live/recorder/cycle_table.h"
#include "recording/text/text.h"
#include "recording/text/yaml_map.h"

namespace flextip::live {
namespace {

bool SameBits(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  for (int i = 0; i < 3; ++i)
    if (std::bit_cast<std::uint64_t>(a[i]) != std::bit_cast<std::uint64_t>(b[i])) return false;
  return true;
}

bool SameBits(const std::optional<Eigen::Vector3d>& a, const std::optional<Eigen::Vector3d>& b) {
  return a.has_value() == b.has_value() && (!a || SameBits(*a, *b));
}

/// A table has no word for numbers that are not finite.
bool SameBits(double a, double b) {
  if (!std::isfinite(a) && !std::isfinite(b)) return true;
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}

/// Older recordings have no findings.
bool SameFindings(const std::optional<Supervision>& was, const std::optional<Supervision>& now) {
  if (!was) return true;
  return now && was->stop == now->stop && was->reaction == now->reaction &&
         was->voted_out == now->voted_out && SameBits(was->chi2, now->chi2) &&
         SameBits(was->chi2_limit, now->chi2_limit) &&
         SameBits(was->worst_angle_rad, now->worst_angle_rad);
}

bool SameCause(const SizedCause& a, const SizedCause& b) {
  return a.cause == b.cause && SameBits(a.value, b.value) && SameBits(a.sd, b.sd);
}

bool SameCause(const FoundCause& a, const FoundCause& b) {
  return SameCause(a.likeliest, b.likeliest) && SameCause(a.other, b.other) &&
         a.has_more == b.has_more && SameBits(a.log_evidence, b.log_evidence) &&
         a.found_ns == b.found_ns && a.since_ns == b.since_ns;
}

}  // namespace

bool SameOutputs(const CycleOutputs& a, const CycleOutputs& b) {
  return a.hold == b.hold && a.held_by == b.held_by && a.has_command == b.has_command &&
         a.status == b.status && SameBits(a.p_RW_command, b.p_RW_command) &&
         SameBits(a.p_RE, b.p_RE) && SameBits(a.p_RE_goal, b.p_RE_goal) &&
         a.step_limited == b.step_limited && a.speed_limited == b.speed_limited &&
         a.acceleration_limited == b.acceleration_limited &&
         a.workspace_limited == b.workspace_limited && a.fixture_limited == b.fixture_limited &&
         a.state_command == b.state_command && a.done == b.done &&
         SameFindings(a.supervision, b.supervision) && SameCause(a.cause, b.cause);
}

bool HasSession(const std::filesystem::path& recording) {
  return std::filesystem::exists(recording / "session0" / "cycles.csv");
}

Session RecordedSession(const std::filesystem::path& recording) {
  const std::filesystem::path folder = recording / "session0";
  return ReadSession(folder / "session.yaml", YamlMap::Load(folder / "run.yaml").Text("folder"));
}

std::unique_ptr<Cycle> CycleAtBegin(const std::filesystem::path& recording,
                                    const Session& session) {
  const std::filesystem::path folder = recording / "session0", file = folder / "state.txt";
  auto cycle =
      std::make_unique<Cycle>(session, YamlMap::Load(folder / "run.yaml").Integer("wait") != 0);
  if (!std::filesystem::exists(file)) return cycle;
  StateText state{ReadTextFile(file)};
  try {
    cycle->VisitState(state);
    state.Finish();
  } catch (const InputError& error) {
    throw InputError::At(file.string(), 0, error.what());
  }
  return cycle;
}

ReplayedSession ReplaySession(const std::filesystem::path& recording, const Session& session) {
  const std::filesystem::path folder = recording / "session0";
  ReadLog log;
  CycleTableReader table(folder / "cycles.csv", log);
  const auto made = CycleAtBegin(recording, session);
  Cycle& cycle = *made;
  ReplayedSession replayed;
  // An excerpt lacks what its warnings come from: the samples before it.
  const bool is_excerpt = std::filesystem::exists(folder / "state.txt");
  while (const auto record = table.Next()) {
    const CycleOutputs& was = record->outputs;
    CycleOutputs again = cycle.Step(record->inputs);
    if (is_excerpt) again.cause = was.cause;
    ReplayedCycle row{record->inputs.t_ns,    was.hold,         again.hold,
                      was.has_command,        was.p_RW_command, again.p_RW_command,
                      SameOutputs(was, again)};
    replayed.equal += row.equal;
    replayed.largest_difference_m =
        std::max(replayed.largest_difference_m, (row.p_RW - row.p_RW_again).norm());
    replayed.cycles.push_back(row);
  }
  replayed.warnings = log.warnings;
  return replayed;
}

}  // namespace flextip::live
