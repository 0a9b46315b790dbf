#include "live/page/state_json.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "vision/tracking/tip_prediction.h"

namespace flextip::live {
namespace {

using Json = nlohmann::ordered_json;

double Seconds(TimeNs span_ns) { return 1e-9 * static_cast<double>(span_ns); }

/// As the holds count it: in lockstep the robot's time is not that of arrivals.
double Age_s(const Session& session, TimeNs t_ns, TimeNs sample_ns, TimeNs arrived_ns) {
  const double age_s = Seconds(t_ns - sample_ns);
  return session.robot.lockstep ? age_s : std::max(age_s, Seconds(t_ns - arrived_ns));
}

Json VectorJson(const Eigen::Vector3d& v) { return Json::array({v.x(), v.y(), v.z()}); }

/// Letters of peers that are no UTF-8 are replaced.
std::string TextOf(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

Json NameOf(int held_by) {
  if (held_by < 0) return nullptr;
  return held_by == kStreams ? "robot" : Name(static_cast<StreamName>(held_by));
}

Json RobotJson(const std::optional<CrtkOperatingState>& robot) {
  if (!robot) return nullptr;
  return {{"state", Name(robot->state)}, {"homed", robot->is_homed}, {"busy", robot->is_busy}};
}

/// The age at which the stream is stale, as the holds count it.
double LimitOf(const Session& session, StreamName stream) {
  const auto& setup = session.Of(stream);
  const double stale_s = setup ? setup->stale_s : session.camera ? session.camera->stale_s : 0.0;
  return stale_s + session.LatencyOf(stream).value_s;
}

bool IsUsed(const Session& session, StreamName stream) {
  return session.Of(stream) || (stream == StreamName::kTip && session.camera);
}

Json StreamsJson(const Session& session, const PageSnapshot& snapshot,
                 const PageFindings& findings) {
  const CycleInputs& inputs = snapshot.record.inputs;
  Json streams = Json::array();
  for (int i = 0; i < kStreams; ++i) {
    const auto stream = static_cast<StreamName>(i);
    if (!IsUsed(session, stream)) continue;
    Json one{{"name", Name(stream)},
             {"age_s", nullptr},
             {"limit_s", LimitOf(session, stream)},
             {"latency_s", session.LatencyOf(stream).value_s},
             {"rate_hz", findings.rates_hz[static_cast<std::size_t>(i)]},
             {"samples", snapshot.accepted[static_cast<std::size_t>(i)]},
             {"lost", (inputs.streams.lost >> i & 1U) != 0}};
    if (const auto times = TimesIn(inputs.streams, stream))
      one["age_s"] = Age_s(session, inputs.t_ns, times->first, times->second);
    streams.push_back(std::move(one));
  }
  return streams;
}

Json EstimateJson(const ControllerCommand& command) {
  const ShaftEstimate& estimate = command.estimate;
  Json json{{"status", Name(estimate.status)}};
  const bool fitted =
      estimate.status == EstimateStatus::kOk || estimate.status == EstimateStatus::kUnobservable;
  if (command.status == ControlStatus::kNoWrist || !fitted) return json;
  json["tip_m"] = VectorJson(estimate.p_RE);
  json["sd_m"] = MaxSd(estimate.p_RE_covariance_m2);
  json["port_m"] = VectorJson(estimate.model.p_RP);
  json["force_N"] = VectorJson(estimate.model.f_tip_N);
  json["inserted_m"] = estimate.model.instrument.length_m - estimate.s_port_m;
  return json;
}

Json WorstJson(const std::optional<WorstMotion>& worst) {
  if (!worst || !worst->found) return nullptr;
  return {{"angle_rad", worst->angle_rad},
          {"at_estimate_rad", worst->angle_at_estimate_rad},
          {"direction", VectorJson(worst->direction)},
          {"deviations", kPageDeviations}};
}

Json LimitedJson(const CycleOutputs& outputs) {
  Json names = Json::array();
  if (outputs.step_limited) names.push_back("step");
  if (outputs.speed_limited) names.push_back("speed");
  if (outputs.acceleration_limited) names.push_back("acceleration");
  if (outputs.workspace_limited) names.push_back("workspace");
  if (outputs.fixture_limited) names.push_back("fixture");
  return names;
}

Json EventJson(const PageEvent& event) {
  Json json{{"n", event.n}, {"t_ns", std::to_string(event.t_ns)}};
  const PageChange& change = event.change;
  if (event.kind == PageEvent::Kind::kText) {
    json["kind"] = "text";
    json["what"] = event.text;
  } else if (event.kind == PageEvent::Kind::kWish) {
    json["kind"] = "person";
    json["wish"] = event.text;
  } else if (change.told) {
    json["kind"] = "told";
    json["told"] = Name(*change.told);
  } else {
    json["kind"] = "change";
    json["hold"] = Name(change.hold);
    json["held_by"] = change.hold == Hold::kSourceLost ? NameOf(change.held_by) : Json();
    json["robot"] = RobotJson(change.state);
  }
  return json;
}

Json EventsJson(const std::vector<PageEvent>& events) {
  Json json = Json::array();
  for (const PageEvent& event : events) json.push_back(EventJson(event));
  return json;
}

Json HistoryJson(const PageHistory& history) {
  Json t = Json::array(), deviation = Json::array(), sd = Json::array(), way = Json::array();
  for (const PageHistory::Row& row : history.Rows()) {
    t.push_back(std::to_string(row.t_ns));
    deviation.push_back(row.deviation_m ? Json(*row.deviation_m) : Json());
    sd.push_back(row.sd_m ? Json(*row.sd_m) : Json());
  }
  for (const Eigen::Vector3d& p : history.Way()) way.push_back(VectorJson(p));
  return {{"t_ns", t}, {"deviation_m", deviation}, {"sd_m", sd}, {"way_m", way}};
}

Json SessionJson(const Session& session, bool can_command) {
  Json waypoints = Json::array();
  if (session.path)
    for (const auto& waypoint : session.task.path.waypoints_m)
      waypoints.push_back(VectorJson(waypoint));
  Json workspace;
  if (const auto& box = session.limits.workspace)
    workspace = {{"lower_m", VectorJson(box->lower_m)}, {"upper_m", VectorJson(box->upper_m)}};
  return {
      {"file", session.file.filename().string()},
      {"controller", Name(session.task.controller.kind)},
      {"rate_hz", session.rate_hz},
      {"lockstep", session.robot.lockstep.has_value()},
      {"length_m", session.base.instrument.length_m},
      {"port_m", VectorJson(session.base.p_RP)},
      {"camera", session.camera.has_value()},
      {"tip_from", session.camera                 ? "cam0"
                   : session.Of(StreamName::kTip) ? "vision0"
                   : session.EmIsTip()            ? "em0"
                                                  : ""},
      {"tracks", UsesTipMeasurement(session.task.controller.kind)},
      {"path", session.path ? session.task.path.frame == PathFrame::kStart ? "start" : "R" : ""},
      {"waypoints_m", std::move(waypoints)},
      {"workspace", std::move(workspace)},
      {"says_state", session.robot.state.has_value()},
      {"can_command", can_command && session.robot.command_state.has_value()}};
}

}  // namespace

std::string HelloText(const Session& session, bool can_command, const PageHistory& history) {
  constexpr std::size_t kEventsTold = 60;
  return TextOf({{"type", "hello"},
                 {"session", SessionJson(session, can_command)},
                 {"history", HistoryJson(history)},
                 {"events", EventsJson(history.Events(kEventsTold))}});
}

std::string StateText(long n, const Session& session, const PageSnapshot& snapshot,
                      const PageFindings& findings, const std::vector<PageEvent>& events,
                      const char* end) {
  const CycleRecord& record = snapshot.record;
  const CycleOutputs& outputs = record.outputs;
  const StreamInputs& streams = record.inputs.streams;
  std::optional<CrtkOperatingState> robot;
  if (streams.state) robot = streams.state->value;
  Json shaft = Json::array();
  for (const ShapePoint& point : findings.now.shape) shaft.push_back(VectorJson(point.p_R));
  Json json{
      {"type", "state"},
      {"n", n},
      {"t_ns", std::to_string(record.inputs.t_ns)},  // more digits than a script's numbers
      {"cycles", snapshot.cycles},
      {"missed", snapshot.missed},
      {"silent_s", findings.silent_s},
      {"hold", Name(outputs.hold)},
      {"held_by", outputs.hold == Hold::kSourceLost ? NameOf(outputs.held_by) : Json()},
      {"robot", RobotJson(robot)},
      {"status", Name(outputs.status)},
      {"limited", LimitedJson(outputs)},
      {"done", outputs.done},
      {"stop", record.inputs.stop},
      {"wrist_m", streams.wrist ? VectorJson(streams.wrist->value.p_RW) : Json()},
      {"command_m", outputs.has_command ? VectorJson(outputs.p_RW_command) : Json()},
      {"seen_m", streams.tip ? VectorJson(streams.tip->value.tip.p_RE) : Json()},
      {"tip_m", snapshot.on_path ? VectorJson(outputs.p_RE) : Json()},
      {"goal_m", outputs.p_RE_goal ? VectorJson(*outputs.p_RE_goal) : Json()},
      {"start_m", snapshot.on_path ? VectorJson(snapshot.p_RE_start) : Json()},
      {"deviation_m", snapshot.on_path ? Json(snapshot.deviation_m) : Json()},
      {"estimate", EstimateJson(snapshot.command)},
      {"shaft_m", std::move(shaft)},
      {"worst", WorstJson(findings.worst)},
      {"streams", StreamsJson(session, snapshot, findings)},
      {"events", EventsJson(events)},
      {"end", end},
      {"late_s", Seconds(record.woke_ns - record.due_ns)},
      {"work_s", record.sent_ns > 0 ? Json(Seconds(record.sent_ns - record.woke_ns)) : Json()}};
  return TextOf(json);
}

std::string AnswerText(const std::string& wish, const char* why) {
  return TextOf({{"type", "answer"}, {"do", wish}, {"accepted", *why == '\0'}, {"why", why}});
}

}  // namespace flextip::live
