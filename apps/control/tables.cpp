#include "apps/control/tables.h"

#include <fmt/format.h>

#include <array>

namespace flextip {
namespace {

using live::Spread;

struct Quantile {
  const char* name;
  double part;
};
constexpr std::array kQuantiles{Quantile{"p50", 0.5}, Quantile{"p99", 0.99},
                                Quantile{"p99.9", 0.999}};

nlohmann::ordered_json SpreadJson(const Spread& spread) {
  nlohmann::ordered_json json{{"count", spread.Count()}};
  for (const Quantile& q : kQuantiles) json[std::string(q.name) + "_s"] = spread.Quantile_s(q.part);
  json["worst_s"] = spread.Worst_s();
  return json;
}

void PrintSpread(const char* name, const Spread& spread) {
  if (spread.Count() == 0) return;
  fmt::print("{:<34}", name);
  for (const Quantile& q : kQuantiles) fmt::print("{:>10.3f}", 1e3 * spread.Quantile_s(q.part));
  fmt::print("{:>10.3f}\n", 1e3 * spread.Worst_s());
}

void PrintHistogram(const Spread& spread) {
  constexpr std::array edges_s{0.0,  2e-5, 5e-5, 1e-4, 2e-4, 5e-4,
                               1e-3, 2e-3, 5e-3, 1e-2, 2e-2, 0.1};
  fmt::print("\n{:<34}{:>10}\n", "late by (ms)", "cycles");
  for (std::size_t i = 0; i + 1 < edges_s.size(); ++i) {
    const long count = spread.Between(edges_s[i], edges_s[i + 1]);
    if (count > 0)
      fmt::print("{:<34}{:>10}\n", fmt::format("{} to {}", 1e3 * edges_s[i], 1e3 * edges_s[i + 1]),
                 count);
  }
}

void PrintLacking(const live::LoopReport& report) {
  if (!report.had_priority)
    fmt::print("no real-time priority: other work delays a cycle (limits.conf: rtprio 10)\n");
  if (!report.had_locked_memory)
    fmt::print("memory not locked: swapping delays a cycle (limits.conf: memlock unlimited)\n");
}

}  // namespace

nlohmann::ordered_json ReportJson(const live::Session& session, const live::LoopReport& report,
                                  bool only_timing) {
  nlohmann::ordered_json streams = nlohmann::ordered_json::object();
  for (int i = 0; i < live::kStreams; ++i) {
    const auto& counts = report.streams[static_cast<std::size_t>(i)];
    if (counts.arrived == 0 && !session.streams[static_cast<std::size_t>(i)]) continue;
    streams[live::Name(static_cast<live::StreamName>(i))] = {
        {"arrived", counts.arrived}, {"accepted", counts.accepted}, {"invalid", counts.invalid},
        {"old", counts.old},         {"unusable", counts.unusable}, {"rate_hz", counts.Rate_hz()}};
  }
  nlohmann::ordered_json camera;
  if (report.camera) {
    camera = {{"pictures", report.camera->pictures},
              {"tips_seen", report.camera->seen},
              {"left_out", report.camera->left_out},
              {"refused", report.camera->refused}};
  }
  return {{"session", session.file.filename().string()},
          {"controller", Name(session.task.controller.kind)},
          {"only_timing", only_timing},
          {"path_done", report.done},
          {"robot_not_enabled_at_end", report.ends_paused},
          {"duration_s", report.seconds},
          {"cycles", report.cycles},
          {"missed_cycles", report.missed},
          {"unsent_commands", report.unsent},
          {"real_time_priority", report.had_priority},
          {"locked_memory", report.had_locked_memory},
          {"holds", report.holds},
          {"limited",
           {{"step", report.step_limited},
            {"speed", report.speed_limited},
            {"acceleration", report.acceleration_limited},
            {"workspace", report.workspace_limited},
            {"fixture", report.fixture_limited}}},
          {"sample_to_command", SpreadJson(report.sample_to_command)},
          {"wake_late", SpreadJson(report.wake)},
          {"work", SpreadJson(report.work)},
          {"bad_states", report.bad_states},
          {"streams", streams},
          {"camera", camera}};
}

void PrintRun(const live::LoopReport& report) {
  fmt::print("{}; {} cycles in {:.1f} s, {} missed; the robot is {}\n",
             report.done ? "the path is done" : "ended before the path was done", report.cycles,
             report.seconds, report.missed, report.ends_paused ? "not enabled" : "ENABLED");
  for (const auto& [hold, cycles] : report.holds) {
    if (hold != "none") fmt::print("  held, {}: {} cycles\n", hold, cycles);
  }
  if (report.camera) {
    fmt::print("  the tip was seen in {} of {} pictures, {} were left out\n", report.camera->seen,
               report.camera->pictures, report.camera->left_out);
  }
  const auto say = [](const char* name, long cycles) {
    if (cycles > 0) fmt::print("  limited, {}: {} cycles\n", name, cycles);
  };
  say("step", report.step_limited);
  say("speed", report.speed_limited);
  say("acceleration", report.acceleration_limited);
  say("workspace", report.workspace_limited);
  say("fixture", report.fixture_limited);
}

void PrintTimes(const live::LoopReport& report) {
  fmt::print("{} cycles in {:.1f} s ({:.1f} Hz), {} missed\n", report.cycles, report.seconds,
             static_cast<double>(report.cycles) / report.seconds, report.missed);
  PrintLacking(report);
  fmt::print("{:<12}{:>10}{:>10}{:>10}{:>10}\n", "stream", "samples", "Hz", "old", "unusable");
  for (int i = 0; i < live::kStreams; ++i) {
    const auto& counts = report.streams[static_cast<std::size_t>(i)];
    if (counts.arrived == 0) continue;
    fmt::print("{:<12}{:>10}{:>10.1f}{:>10}{:>10}\n", live::Name(live::StreamName(i)),
               counts.accepted, counts.Rate_hz(), counts.old, counts.unusable);
  }
  fmt::print("\n{:<34}{:>10}{:>10}{:>10}{:>10}\n", "time (ms)", "p50", "p99", "p99.9", "worst");
  PrintSpread("wrist's sample to command sent", report.sample_to_command);
  PrintSpread("cycle due to begun", report.wake);
  PrintSpread("cycle begun to command sent", report.work);
  PrintHistogram(report.wake);
}

}  // namespace flextip
