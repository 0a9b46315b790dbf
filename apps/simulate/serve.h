// flextip simulate --serve: a robot that is not there, for clients.
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <optional>

namespace flextip {

struct ServeCommand {
  std::filesystem::path scenario, out;  ///< `out` empty: nothing is written
  std::optional<int> port;              ///< empty: no --serve
  std::optional<int> udp_port;          ///< empty: no --udp
  std::optional<int> ros2_domain;       ///< empty: that of ROS_DOMAIN_ID
  std::optional<double> duration_s, rate_hz;
  bool lockstep = false, any_address = false, render = false, force = false;
  bool ros2 = false;
};

/// Adds --serve and the options that need it. Returns --serve.
CLI::Option* AddServeOptions(CLI::App& command, ServeCommand& options);

/// Serves until Ctrl-C, the duration's end, or, in lockstep, until its client has left; then writes
/// the session where `out` is given. Throws as live::Serve.
void RunServe(const ServeCommand& options, bool quiet);

}  // namespace flextip
