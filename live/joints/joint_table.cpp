#include "live/joints/joint_table.h"

#include <fmt/format.h>

#include "recording/text/csv.h"

namespace flextip::live {
namespace {

constexpr std::size_t kFixed = 14;  // columns before those of the joints

std::vector<std::string> ColumnsOf(int joints) {
  std::vector<std::string> columns{
      "timestamp [ns]", "measured [ns]",      "state",     "lost",          "stop",
      "hold",           "has_command",        "sent",      "state_command", "path [s]",
      "rate_limited",   "correction_limited", "taking_up", "over"};
  for (const char* what : {"q", "effort", "command"})
    for (int i = 0; i < joints; ++i) columns.push_back(fmt::format("{}{} []", what, i + 1));
  return columns;
}

void AddJoints(CsvWriter& csv, const JointVector& values, int joints) {
  for (int i = 0; i < joints; ++i) values.size() == joints ? csv.Add(values[i]) : csv.AddEmpty();
}

JointVector JointsIn(const CsvReader& csv, std::size_t first, int joints) {
  if (csv.Empty(first)) return {};
  JointVector values(joints);
  for (int i = 0; i < joints; ++i) values[i] = csv.Number(first + std::size_t(i));
  return values;
}

bool Same(const JointOutputs& a, const JointOutputs& b) {
  return a.hold == b.hold && a.has_command == b.has_command && a.q == b.q &&
         a.state_command == b.state_command && a.path_s == b.path_s &&
         a.rate_limited == b.rate_limited && a.correction_limited == b.correction_limited &&
         a.taking_up == b.taking_up && a.over == b.over;
}

}  // namespace

std::string JointCyclesCsv(const std::deque<JointRecord>& cycles, int joints) {
  CsvWriter csv(ColumnsOf(joints));
  for (const JointRecord& record : cycles) {
    const auto& [inputs, outputs, sent] = record;
    csv.Add(inputs.t_ns).Add(inputs.measured_ns);
    csv.Add(inputs.state ? Text(*inputs.state) : std::string());
    csv.Add(TimeNs{inputs.lost}).Add(TimeNs{inputs.stop});
    csv.Add(static_cast<TimeNs>(outputs.hold)).Add(TimeNs{outputs.has_command}).Add(TimeNs{sent});
    csv.Add(outputs.state_command ? std::string(Name(*outputs.state_command)) : std::string());
    csv.Add(outputs.path_s).Add(TimeNs{outputs.rate_limited});
    csv.Add(TimeNs{outputs.correction_limited}).Add(TimeNs{outputs.taking_up});
    csv.Add(TimeNs{outputs.over});
    AddJoints(csv, inputs.q, joints);
    AddJoints(csv, inputs.effort, joints);
    AddJoints(csv, outputs.q, joints);
    csv.EndRow();
  }
  return csv.text();
}

std::deque<JointRecord> ReadJointCycles(const std::filesystem::path& file, int joints,
                                        ReadLog& log) {
  CsvReader csv(file, ColumnsOf(joints), log);
  std::deque<JointRecord> cycles;
  const auto n = std::size_t(joints);
  while (csv.Next()) {
    JointRecord record;
    JointInputs& inputs = record.inputs;
    JointOutputs& outputs = record.outputs;
    inputs.t_ns = csv.Integer(0);
    inputs.measured_ns = csv.Integer(1);
    inputs.state = CrtkOperatingStateOf(csv.Text(2));
    inputs.lost = csv.Integer(3) != 0;
    inputs.stop = csv.Integer(4) != 0;
    const TimeNs hold = csv.Integer(5);
    if (hold < 0 || hold > static_cast<TimeNs>(JointHold::kDone))
      throw csv.Error(fmt::format("found the hold {}, which is unknown", hold));
    outputs.hold = static_cast<JointHold>(hold);
    outputs.has_command = csv.Integer(6) != 0;
    record.sent = csv.Integer(7) != 0;
    outputs.state_command = CrtkCommandOf(csv.Text(8));
    outputs.path_s = csv.Number(9);
    outputs.rate_limited = csv.Integer(10) != 0;
    outputs.correction_limited = csv.Integer(11) != 0;
    outputs.taking_up = csv.Integer(12) != 0;
    outputs.over = csv.Integer(13) != 0;
    inputs.q = JointsIn(csv, kFixed, joints);
    inputs.effort = JointsIn(csv, kFixed + n, joints);
    outputs.q = JointsIn(csv, kFixed + 2 * n, joints);
    cycles.push_back(std::move(record));
  }
  return cycles;
}

long CyclesThatDiffer(const std::deque<JointRecord>& cycles, JointCycle cycle) {
  long differ = 0;
  for (const JointRecord& record : cycles)
    differ += !Same(record.outputs, cycle.Step(record.inputs));
  return differ;
}

}  // namespace flextip::live
