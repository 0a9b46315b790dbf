#include "apps/control/joint_session.h"

#include <fmt/format.h>

#include <deque>
#include <memory>
#include <nlohmann/json.hpp>

#include "apps/common/output.h"
#include "apps/control/joints.h"
#include "arms/diagnose/model_file.h"
#include "arms/feed_forward/joint_model.h"
#include "arms/feed_forward/sampled_path.h"
#include "core/error.h"
#include "live/joints/joint_loop.h"
#include "live/joints/joint_table.h"
#include "recording/recording_reader.h"
#include "recording/recording_writer.h"
#include "recording/text/text.h"

namespace flextip {
namespace {

namespace fs = std::filesystem;

constexpr const char* kCycles = "session0/joint_cycles.csv";
constexpr const char* kSession = "session0/session.yaml";
constexpr const char* kDesired = "session0/desired";
constexpr const char* kModel = "session0/model.yaml";

/// What a session is about, read from its files.
struct Task {
  live::JointSession session;
  Recording wish;
  JointModel model{1};
  std::vector<std::string> not_corrected, warnings;
  std::shared_ptr<const arms::SampledPath> path;

  int Joints() const { return wish.arm->Size(); }
};

JointVector LimitOf(const std::vector<double>& given, const Task& task, double rad, double m,
                    const char* name) {
  const int n = task.Joints();
  if (given.empty()) {
    JointVector usual(n);
    for (int i = 0; i < n; ++i) usual[i] = task.model.turns[std::size_t(i)] ? rad : m;
    return usual;
  }
  if (int(given.size()) != n) {
    throw InputError::At(
        task.session.file.string(), 0,
        fmt::format("{}: found {} numbers, expected {}, a joint each", name, given.size(), n));
  }
  return Eigen::Map<const Eigen::VectorXd>(given.data(), n);
}

Task ReadTask(const fs::path& session_file, const fs::path& desired, const fs::path& model) {
  Task task;
  task.session = live::ReadJointSession(session_file);
  if (!desired.empty()) task.session.desired = desired;
  if (!model.empty()) task.session.model = model;
  const ReadResult read = ReadRecording(task.session.desired);
  task.wish = read.recording;
  task.warnings = read.warnings;
  RequireDesiredJoints(task.wish, task.session.desired);
  const arms::ArmModel found =
      task.session.model.empty() ? arms::ArmModel{} : arms::ReadArmModel(task.session.model);
  arms::CommandModel command = arms::CommandModelOf(*task.wish.arm, found, task.wish.gravity_m_s2);
  task.model = command.joints;
  task.not_corrected = command.not_corrected;
  task.path = std::make_shared<const arms::SampledPath>(TrackOfJoints(*task.wish.joints_command0));
  return task;
}

live::JointCycle CycleOf(const Task& task, bool wait) {
  live::JointCycleOptions options;
  const live::JointSession& session = task.session;
  options.stale_s = session.stale_s;
  options.wait = wait;
  options.follow_limit = LimitOf(session.follow_limit, task, 0.2, 0.02, "follow_limit");
  options.approach_rate = LimitOf(session.approach_rate, task, 0.2, 0.02, "approach_rate");
  options.feed_forward.max_rate = LimitOf(session.max_rate, task, 10.0, 1.0, "max_rate");
  options.feed_forward.max_correction =
      LimitOf(session.max_correction, task, 0.5, 0.05, "max_correction");
  live::JointWay way;
  const auto path = task.path;
  way.wish = [path](double t_s, const JointFeedForward& feed_forward) {
    return path->WishAt(t_s, feed_forward);
  };
  way.seconds = path->Rows().t_s[path->Rows().Rows() - 1];
  return {task.model, way, options};
}

/// The cycles as streams of a recording.
Recording RecordingOf(const Task& task, const std::deque<live::JointRecord>& cycles) {
  Recording recording;
  recording.has_shaft = false;
  recording.gravity_m_s2 = task.wish.gravity_m_s2;
  recording.arm = task.wish.arm;
  JointStream commands = *task.wish.joints_command0, measured = commands;
  commands.q.clear();
  measured.q.clear();
  commands.rate_hz = measured.rate_hz = task.session.rate_hz;
  measured.noise.assign(commands.types.size(), 0.0);
  for (std::size_t i = 0; i < measured.noise.size(); ++i)
    measured.noise[i] = commands.types[i] == JointType::kRevolute ? 1e-4 : 1e-5;
  TorqueStream torque;
  torque.rate_hz = task.session.rate_hz;
  torque.types = commands.types;
  for (const JointType type : torque.types)
    torque.noise.push_back(type == JointType::kRevolute ? 0.05 : 0.5);
  for (const live::JointRecord& record : cycles) {
    const auto& [inputs, outputs, sent] = record;
    if (sent) commands.q.push_back({inputs.t_ns, outputs.q});
    const bool fresh = measured.q.empty() || inputs.measured_ns > measured.q.back().t_ns;
    if (inputs.measured_ns == 0 || !fresh) continue;
    measured.q.push_back({inputs.measured_ns, inputs.q});
    if (inputs.effort.size() > 0) torque.tau.push_back({inputs.measured_ns, inputs.effort});
  }
  if (!commands.q.empty()) recording.joints_command0 = commands;
  if (!measured.q.empty()) recording.joints0 = measured;
  if (!torque.tau.empty()) recording.torque0 = torque;
  return recording;
}

}  // namespace

void ControlJoints(const JointSessionRun& run) {
  if (run.out.empty()) throw InputError("-o RECORDING is missing, expected it");
  const Task task = ReadTask(run.session, {}, {});
  OutputFolder output(run.out, "control joints",
                      {.force = run.force, .inputs = {run.session, task.session.desired}});
  output.OnlyNoteInterrupt();
  output.Warn(task.warnings);
  const int n = task.Joints();
  const live::JointLoopReport report = live::RunJoints(
      task.session, CycleOf(task, run.wait), n,
      {.duration_s = run.duration_s, .stop = [&] { return output.StopRequested(); }});
  output.Warn(report.events);
  if (const long lacking = report.cycle_count - long(report.cycles.size()); lacking > 0)
    output.Warn(fmt::format("the last {} cycles are not in the recording", lacking));
  WriteRecording(output.folder(), RecordingOf(task, report.cycles));
  WriteTextFile(output.folder() / kCycles, live::JointCyclesCsv(report.cycles, n));
  WriteTextFile(output.folder() / kSession, ReadTextFile(run.session));
  if (!task.session.model.empty())
    WriteTextFile(output.folder() / kModel, ReadTextFile(task.session.model));
  Recording wish;
  wish.has_shaft = false;
  wish.gravity_m_s2 = task.wish.gravity_m_s2;
  wish.arm = task.wish.arm;
  wish.joints_command0 = task.wish.joints_command0;
  fs::create_directories(output.folder() / kDesired);
  WriteRecording(output.folder() / kDesired, wish);
  output.WriteSummary({{"cycles", report.cycle_count},
                       {"missed_beats", report.missed},
                       {"unsent", report.unsent},
                       {"limited_cycles", report.limited},
                       {"bad_messages", report.bad_messages},
                       {"done", report.done},
                       {"last_hold", live::Name(report.last_hold)},
                       {"waited", run.wait},
                       {"not_corrected", task.not_corrected}});
  output.Commit();
  if (!run.quiet) {
    fmt::print("{} cycles, {} missed; {}\n{}\n", report.cycle_count, report.missed,
               report.done ? "the path is done"
                           : fmt::format("it ended: {}", live::Name(report.last_hold)),
               (run.out / "joints0").string());
  }
}

bool HasJointCycles(const fs::path& recording) { return fs::exists(recording / kCycles); }

JointReplay ReplayJointCycles(const fs::path& recording) {
  const fs::path model = recording / kModel;
  const Task task =
      ReadTask(recording / kSession, recording / kDesired, fs::exists(model) ? model : fs::path());
  ReadLog log;
  const auto cycles = live::ReadJointCycles(recording / kCycles, task.Joints(), log);
  const auto summary = nlohmann::json::parse(ReadTextFile(recording / "summary.json"));
  const live::JointCycle cycle = CycleOf(task, summary.value("waited", false));
  return {long(cycles.size()), live::CyclesThatDiffer(cycles, cycle)};
}

}  // namespace flextip
