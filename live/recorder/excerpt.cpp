#include "live/recorder/excerpt.h"

#include <algorithm>
#include <memory>
#include <set>

#include "live/recorder/cycle_table.h"
#include "live/recorder/replay.h"
#include "recording/cut.h"
#include "recording/recording_reader.h"
#include "recording/recording_writer.h"
#include "recording/text/csv.h"
#include "recording/text/text.h"
#include "stops/open_excerpt.h"

namespace flextip::live {
namespace {

namespace fs = std::filesystem;

/// Why the robot is held in this cycle; empty where it is not, or a person wants it so.
/// `last`: of the cycle before, which goes on while the robot resumes.
const char* CauseOf(const CycleRecord& record, const char* last) {
  const CycleOutputs& outputs = record.outputs;
  if (record.inputs.stop || outputs.hold == Hold::kStopped || !outputs.has_command) return "";
  const auto& found = outputs.supervision;
  if (found && found->reaction >= Reaction::kHold) return Name(found->stop);
  switch (outputs.hold) {
    case Hold::kResuming:
      return last;
    case Hold::kBadTime:
    case Hold::kSourceLost:
    case Hold::kStaleWrist:
    case Hold::kStaleTip:
    case Hold::kNotFinite:
      return Name(outputs.hold);
    default:
      return "";
  }
}

/// Knows the causes of cycles in their order.
class Watch {
 public:
  WatchedCycle Look(const CycleRecord& record) {
    const CycleOutputs& outputs = record.outputs;
    begun_ |= outputs.p_RE_goal.has_value();
    cause_ = CauseOf(record, cause_);
    const auto& found = outputs.supervision;
    const bool fault = *cause_ != '\0' && found && found->reaction == Reaction::kFault;
    return {record.inputs.t_ns, cause_, fault, begun_};
  }

 private:
  const char* cause_ = "";
  bool begun_ = false;
};

/// One excerpt while its cycles go by.
struct Open : OpenExcerpt {
  explicit Open(const OpenExcerpt& excerpt) : OpenExcerpt(excerpt) {}
  CycleTableWriter table;
  std::string lost;  // the source of a source_lost
};

Moment MomentOf(const CycleRecord& record, const Cycle& cycle, const char* cause) {
  const CycleOutputs& outputs = record.outputs;
  Moment moment;
  moment.t_ns = record.inputs.t_ns;
  moment.readings = cycle.Readings(record.inputs.streams);
  moment.p_RE_wanted = outputs.p_RE_goal;
  if (cycle.LastCommand().status != ControlStatus::kNoWrist) moment.p_RE_used = outputs.p_RE;
  moment.f_tip_N = cycle.LastCommand().estimate.model.f_tip_N;
  if (outputs.has_command) moment.p_RW_sent = outputs.p_RW_command;
  moment.cause = cause;
  moment.supervision = outputs.supervision.value_or(Supervision());
  return moment;
}

/// The session with the files it names; the rows of its tables come anew.
void CopySession(const fs::path& from, const fs::path& to) {
  static const std::set<std::string> kTables{"cycles.csv", "events.csv", "state.txt"};
  fs::create_directories(to);
  for (const auto& entry : fs::recursive_directory_iterator(from)) {
    const fs::path name = fs::relative(entry.path(), from);
    if (entry.is_directory() || kTables.contains(name.string())) continue;
    fs::create_directories((to / name).parent_path());
    fs::copy_file(entry.path(), to / name, fs::copy_options::overwrite_existing);
  }
}

void CopyEvents(const fs::path& from, const fs::path& to, const Open& open) {
  const std::vector<std::string> columns{"timestamp [ns]", "event []"};
  CsvWriter rows(columns);
  ReadLog log;
  CsvReader csv(from, columns, log);
  while (csv.Next()) {
    const TimeNs t_ns = csv.Integer(0);
    if (t_ns < open.from_ns || t_ns > open.to_ns) continue;
    rows.Add(t_ns).Add(std::string(csv.Text(1)));
    rows.EndRow();
  }
  WriteTextFile(to, rows.text());
}

class ExcerptWriter {
 public:
  ExcerptWriter(const fs::path& recording, const fs::path& to, const std::vector<StopEvent>& found)
      : from_(recording),
        to_(to),
        session_(RecordedSession(recording)),
        streams_(ReadRecording(recording, {.check_frames = false}).recording),
        stops_(StopsFound(found)) {
    for (const OpenExcerpt& open : OpenExcerpts(found, stops_))
      waiting_.push_back(std::make_unique<Open>(open));
  }

  StopsOfRun Write() {
    RunAgain();
    return stops_;
  }

 private:
  void RunAgain() {
    ReadLog log;
    CycleTableReader table(from_ / "session0" / "cycles.csv", log);
    const auto made = CycleAtBegin(from_, session_);
    Cycle& cycle = *made;
    Watch watch;
    while (const auto record = table.Next()) {
      const TimeNs t_ns = record->inputs.t_ns;
      if (start_ns_ == 0) start_ns_ = t_ns;
      for (const auto& open : waiting_) {
        if (open && open->state.empty() && t_ns >= open->from_ns) Begin(cycle, *open);
      }
      const CycleOutputs again = cycle.Step(record->inputs);
      const WatchedCycle watched = watch.Look(*record);
      bool waits = false;
      for (auto& open : waiting_) {
        if (!open) continue;
        waits = true;
        if (open->state.empty()) continue;
        if (t_ns > open->to_ns) {
          Finish(*open);
          open.reset();
          continue;
        }
        open->table.Add(*record);
        open->differ += !SameOutputs(record->outputs, again);
        open->moments.push_back(MomentOf(*record, cycle, watched.cause));
        if (t_ns == open->stop.begin_ns && record->outputs.held_by >= 0)
          open->lost = PeerName(record->outputs.held_by);
      }
      if (!waits) break;
    }
    for (auto& open : waiting_)
      if (open && !open->state.empty()) Finish(*open);
  }

  static void Begin(Cycle& cycle, Open& open) {
    StateText state;
    cycle.VisitState(state);
    open.state = state.Text();
  }

  void Finish(Open& open) {
    const fs::path folder = to_ / stops_.kept[open.number].folder, inside = folder / "session0";
    fs::create_directories(folder);
    CopySession(from_ / "session0", inside);
    WriteTextFile(inside / "cycles.csv", open.table.TakeText());
    WriteTextFile(inside / "state.txt", open.state);
    CopyEvents(from_ / "session0" / "events.csv", inside / "events.csv", open);
    WriteRecording(folder, Cut(streams_, open.from_ns, open.to_ns));
    const StoppedRun run{
        start_ns_, OptionsOf(session_).estimator, session_.task.supervision.max_motion_angle_rad,
        session_.task.supervision.max_tip_force_N, [&] { return ModelOf(session_); }};
    CloseExcerpt(open, run, folder, open.lost,
                 "the recording lacks cycles, or another program made it", stops_);
  }

  fs::path from_, to_;
  Session session_;
  Recording streams_;
  TimeNs start_ns_ = 0;
  std::vector<std::unique_ptr<Open>> waiting_;
  StopsOfRun stops_;
};

}  // namespace

std::vector<StopEvent> FindStops(const fs::path& recording, ReadLog& log) {
  CycleTableReader table(recording / "session0" / "cycles.csv", log);
  Watch watch;
  StopFinder finder;
  bool knows = false;  // an older table lacks the findings
  while (const auto record = table.Next()) {
    knows |= record->outputs.supervision.has_value();
    finder.Add(watch.Look(*record));
  }
  return knows ? finder.Stops() : std::vector<StopEvent>();
}

StopsOfRun WriteExcerpts(const fs::path& recording, const fs::path& to) {
  ReadLog log;
  const std::vector<StopEvent> found = FindStops(recording, log);
  if (found.empty()) return {};
  return ExcerptWriter(recording, to, found).Write();
}

}  // namespace flextip::live
