#include "apps/simulate/serve.h"

#include <fmt/format.h>

#include <cstdio>
#include <nlohmann/json.hpp>

#include "apps/common/interruption.h"
#include "apps/common/output.h"
#include "apps/simulate/frame_files.h"
#include "core/error.h"
#include "live/dds/node.h"
#include "live/serve/serve.h"
#include "recording/recording_writer.h"
#include "recording/truth.h"
#include "report/pages.h"
#include "simulation/closed_loop/scenario_run.h"

namespace flextip {
namespace {

constexpr int kLastPort = 65535;

nlohmann::json FiguresJson(const live::ServeFigures& figures) {
  nlohmann::json json = {{"duration_s", figures.duration_s},
                         {"messages_sent", figures.messages_sent},
                         {"pictures_sent", figures.pictures_sent},
                         {"set_points", figures.set_points},
                         {"set_points_not_followed", figures.set_points_off},
                         {"state_commands", figures.commands},
                         {"state_commands_refused", figures.commands_refused},
                         {"messages_refused", figures.counts.refused},
                         {"messages_repeated", figures.counts.repeated},
                         {"messages_out_of_order", figures.counts.out_of_order},
                         {"messages_unsent", figures.counts.unsent},
                         {"tip_travel_m", figures.tip_travel_m},
                         {"tip_from_start_m", figures.tip_from_start_m},
                         {"wrist_from_start_m", figures.wrist_from_start_m},
                         {"state", figures.state}};
  if (figures.cycles > 0) json["cycles"] = figures.cycles;
  if (!figures.fault.empty()) json["fault"] = figures.fault;
  return json;
}

void PrintFigures(const live::ServeFigures& figures) {
  fmt::print("{:<28} {:>12.3f} s\n", "served", figures.duration_s);
  if (figures.cycles > 0) {
    fmt::print("{:<28} {:>12}\n", "cycles", figures.cycles);
  } else {
    fmt::print("{:<28} {:>12.1f} ms\n", "longest delay of a sample", 1e3 * figures.longest_delay_s);
  }
  fmt::print("{:<28} {:>12}\n", "messages sent", figures.messages_sent + figures.pictures_sent);
  fmt::print("{:<28} {:>12} ({} not followed)\n", "set-points followed", figures.set_points,
             figures.set_points_off);
  fmt::print("{:<28} {:>12} ({} refused)\n", "state commands", figures.commands,
             figures.commands_refused);
  fmt::print("{:<28} {:>12.3f} mm\n", "travel of the tip", 1e3 * figures.tip_travel_m);
  fmt::print("{:<28} {:>12.3f} mm\n", "tip from its start", 1e3 * figures.tip_from_start_m);
  fmt::print("{:<28} {:>12}\n", "state at the end", figures.state);
  if (!figures.fault.empty()) fmt::print("fault: {}\n", figures.fault);
}

void CheckOptions(const ServeCommand& options, const simulation::Scenario& scenario) {
  const auto positive = [](const char* option, const std::optional<double>& value) {
    if (value && !(*value > 0.0))
      throw InputError(fmt::format("{}: found {}, expected more than 0", option, *value));
  };
  if (*options.port < 0 || *options.port > kLastPort)
    throw InputError(fmt::format("--serve: found {}, expected 0 to {}", *options.port, kLastPort));
  if (options.udp_port && (*options.udp_port < 1 || *options.udp_port > kLastPort))
    throw InputError(
        fmt::format("--udp: found {}, expected 1 to {}", *options.udp_port, kLastPort));
  if (options.ros2_domain && (*options.ros2_domain < 0 || *options.ros2_domain > live::kLastDomain))
    throw InputError(fmt::format("--ros2-domain: found {}, expected 0 to {}", *options.ros2_domain,
                                 live::kLastDomain));
  positive("--duration", options.duration_s);
  positive("--rate", options.rate_hz);
  if (options.render && !scenario.has_camera)
    simulation::RequireRunnable(scenario, options.scenario, true);
}

}  // namespace

CLI::Option* AddServeOptions(CLI::App& command, ServeCommand& options) {
  auto* serve =
      command
          .add_option("--serve", options.port,
                      "Be a robot that is not there: serve the instrument by OpenIGTLink on this "
                      "port (0: a free one), in real time, without a controller; -o is not needed")
          ->type_name("PORT");
  command
      .add_flag("--lockstep", options.lockstep,
                "With --serve: the robot's clock waits for a set-point each cycle; end when the "
                "client leaves")
      ->needs(serve);
  command
      .add_option("--rate", options.rate_hz,
                  "With --lockstep: cycles per second (default: the scenario's control rate)")
      ->needs(serve)
      ->type_name("HZ");
  auto* ros2 = command
                   .add_flag("--ros2", options.ros2,
                             "With --serve: be a node of ROS 2 too, on this machine alone unless "
                             "--any-address")
                   ->needs(serve);
  command
      .add_option("--ros2-domain", options.ros2_domain,
                  "With --ros2: its domain (default: ROS_DOMAIN_ID, or 0)")
      ->needs(ros2)
      ->type_name("N");
  command
      .add_option("--udp", options.udp_port,
                  "With --serve: send the poses of wrist and EM sensors to this port of this "
                  "machine too, as dVRK's JSON datagrams")
      ->needs(serve)
      ->type_name("PORT");
  command.add_option("--duration", options.duration_s, "With --serve: end after this time")
      ->needs(serve)
      ->type_name("S");
  command
      .add_flag("--any-address", options.any_address,
                "With --serve: listen on every address of this machine, not on 127.0.0.1 alone")
      ->needs(serve);
  return serve;
}

void RunServe(const ServeCommand& options, bool quiet) {
  const simulation::Scenario scenario = simulation::ReadScenario(options.scenario);
  CheckOptions(options, scenario);
  std::optional<OutputFolder> output;
  std::optional<Interruption> interruption;
  if (options.out.empty()) {
    interruption.emplace("");
    interruption->OnlyNote();
  } else {
    output.emplace(options.out, "simulate",
                   OutputOptions{.force = options.force, .inputs = {options.scenario}});
    output->OnlyNoteInterrupt();
    output->Warn(scenario.warnings);
  }
  std::optional<simulation::Laparoscope> laparoscope;
  if (options.render) laparoscope.emplace(simulation::LaparoscopeOf(scenario));
  std::optional<FrameFiles> frames;
  if (options.render && output) frames.emplace(output->folder(), true);

  live::ServeOptions serve;
  serve.port = *options.port;
  serve.any_address = options.any_address;
  if (options.ros2)
    serve.ros2_domain = options.ros2_domain ? *options.ros2_domain : live::RosDomain();
  serve.udp_port = options.udp_port;
  serve.lockstep = options.lockstep;
  serve.rate_hz = options.rate_hz.value_or(0.0);
  serve.duration_s = options.duration_s;
  serve.keep = output.has_value();
  serve.stop = [&] { return output ? output->StopRequested() : interruption->Requested(); };
  serve.serving = [&](int port) {
    fmt::print("serving on {}:{}\n", options.any_address ? "0.0.0.0" : "127.0.0.1", port);
    if (serve.ros2_domain) fmt::print("a node of ROS 2 in domain {}\n", *serve.ros2_domain);
    std::fflush(stdout);
  };
  serve.say = [&](const std::string& line) {
    if (quiet) return;
    fmt::print("{}\n", line);
    std::fflush(stdout);
  };
  if (frames) serve.save = [&](TimeNs t_ns, const Image& image) { frames->Add(t_ns, image); };
  live::ServeResult result = live::Serve(scenario, laparoscope ? &*laparoscope : nullptr, serve);

  if (output) {
    if (result.truth.empty())
      throw WorkError("nothing to write: it was served for less than a cycle");
    if (frames) frames->Finish(result.recording);
    WriteRecording(output->folder(), result.recording);
    WriteTruth(output->folder(), result.truth);
    output->WriteSummary({{"scenario", options.scenario.filename().string()},
                          {"rendered", options.render},
                          {"served", FiguresJson(result.figures)}});
    report::WriteSimulateReport(output->folder());
    output->Commit();
  }
  if (quiet) return;
  PrintFigures(result.figures);
  if (output) fmt::print("report: {}\n", (options.out / "report.html").string());
}

}  // namespace flextip
