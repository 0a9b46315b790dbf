#include "live/recorder/recorder.h"

#include <fmt/format.h>

#include <chrono>
#include <utility>

#include "core/error.h"
#include "diagnosis/running/running_diagnosis.h"
#include "recording/recording_file.h"
#include "recording/streams/sensor_streams.h"
#include "recording/text/text.h"
#include "recording/text/yaml_map.h"

namespace flextip::live {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kSamples = 8192, kCycles = 8192;  // that wait for the disk
constexpr std::chrono::milliseconds kPause(10);

fs::path MadeSession0(const fs::path& folder) {
  fs::create_directories(folder / "session0");
  return folder;
}

/// The session file with the files it names, for replay.
void CopySession(const Session& session, bool wait, const fs::path& to) {
  fs::copy_file(session.file, to / "session.yaml", fs::copy_options::overwrite_existing);
  for (const fs::path& name : session.named_files) {
    if (name.is_absolute() || name.lexically_normal().string().starts_with("..")) continue;
    fs::create_directories((to / name).parent_path());
    fs::copy_file(session.file.parent_path() / name, to / name,
                  fs::copy_options::overwrite_existing);
  }
  WriteTextFile(
      to / "run.yaml",
      fmt::format("folder: {}\nwait: {}\n",
                  YamlText(fs::absolute(session.file).parent_path().string()), wait ? 1 : 0));
}

}  // namespace

Recorder::Recorder(const fs::path& folder, const Session& session, bool wait)
    : folder_(MadeSession0(folder)),
      session_(session),
      samples_{Ring<Arrived<AnySample>>(kSamples), Ring<Arrived<AnySample>>(kSamples),
               Ring<Arrived<AnySample>>(kSamples), Ring<Arrived<AnySample>>(kSamples),
               Ring<Arrived<AnySample>>(kSamples), Ring<Arrived<AnySample>>(kSamples)},
      cycles_(kCycles),
      commands_(folder_, Name(session.task.controller.kind), session.rate_hz, session.base),
      cycles_file_(folder_ / "session0" / "cycles.csv"),
      events_file_(folder_ / "session0" / "events.csv") {
  CopySession(session, wait, folder_ / "session0");
  for (int i = 0; i < kStreams; ++i)
    streams_.emplace_back(folder_, static_cast<StreamName>(i), session.base);
  WriteRecordingFile(folder_ / "recording.yaml", session.base);
  if (session.base.tags0) WriteTags(folder_ / "tags0", *session.base.tags0);
  cycles_file_.Append(table_.TakeText());
  events_file_.Append("#timestamp [ns],event []\n");
  thread_ = std::jthread([this](const std::stop_token& stop) { Run(stop); });
}

Recorder::~Recorder() {
  if (thread_.joinable()) {
    thread_.request_stop();
    thread_.join();
  }
}

void Recorder::Take(StreamName stream, const Arrived<AnySample>& sample) {
  samples_[static_cast<std::size_t>(stream)].Push(sample);
}

void Recorder::Take(const CycleRecord& record) { cycles_.Push(record); }

void Recorder::TakeEvent(TimeNs t_ns, const std::string& what) {
  const std::lock_guard<std::mutex> lock(events_mutex_);
  events_.emplace_back(t_ns, what);
}

long Recorder::Dropped() const {
  long dropped = cycles_.Dropped();
  for (const auto& ring : samples_) dropped += ring.Dropped();
  return dropped;
}

void Recorder::Run(const std::stop_token& stop) {
  for (bool last = false; !last; std::this_thread::sleep_for(last ? kPause * 0 : kPause)) {
    last = stop.stop_requested();
    try {
      WriteAll();
    } catch (const std::exception& error) {
      if (problem_.empty()) problem_ = error.what();
    }
  }
}

void Recorder::WriteAll() {
  for (std::size_t i = 0; i < kStreams; ++i) {
    samples_[i].Drain([&](const Arrived<AnySample>& sample) { streams_[i].Add(sample); });
    streams_[i].Flush();
  }
  cycles_.Drain([&](const CycleRecord& record) { WriteCycle(record); });
  cycles_file_.Append(table_.TakeText());
  commands_.Flush();
  std::vector<std::pair<TimeNs, std::string>> events;
  {
    const std::lock_guard<std::mutex> lock(events_mutex_);
    events.swap(events_);
  }
  if (events.empty()) return;
  CsvWriter csv({"timestamp [ns]", "event []"});
  (void)csv.TakeText();
  for (auto& [t_ns, what] : events) {
    for (char& c : what)
      if (static_cast<unsigned char>(c) < 0x20) c = ' ';
    csv.Add(t_ns).Add(what);
    csv.EndRow();
  }
  events_file_.Append(csv.TakeText());
}

void Recorder::WriteCycle(const CycleRecord& record) {
  table_.Add(record);
  if (record.outputs.has_command && record.outputs.p_RW_command.allFinite())
    commands_.Add({record.inputs.t_ns, record.sent_ns, record.outputs.p_RW_command});
  NoteChanges(record);
}

/// Holds, states of the robot and commands for it as events.
void Recorder::NoteChanges(const CycleRecord& record) {
  const CycleOutputs& outputs = record.outputs;
  const auto& state = record.inputs.streams.state;
  std::string now = fmt::format("hold: {}", Name(outputs.hold));
  if (outputs.hold == Hold::kSourceLost && outputs.held_by >= 0) {
    now += fmt::format(" {}", PeerName(outputs.held_by));
  }
  now += fmt::format("; robot: {}", state ? Text(state->value) : "not known");
  if (outputs.state_command)
    TakeEvent(record.inputs.t_ns, fmt::format("told the robot: {}", Name(*outputs.state_command)));
  if (IsNews(outputs.cause, last_cause_)) {
    last_cause_ = outputs.cause;
    TakeEvent(record.inputs.t_ns, fmt::format("warning: {}", diagnosis::Text(outputs.cause)));
  }
  if (now == last_change_) return;
  last_change_ = now;
  TakeEvent(record.inputs.t_ns, now);
}

void Recorder::Finish() {
  if (thread_.joinable()) {
    thread_.request_stop();
    thread_.join();
  }
  if (!problem_.empty()) throw WorkError(problem_);
  WriteAll();  // the events of the last cycles
  for (StreamFile& stream : streams_) stream.Finish();
  commands_.Finish();
}

}  // namespace flextip::live
