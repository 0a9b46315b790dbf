// How well flextip align finds the clocks of sessions with known clocks, in a table.
#include <fmt/format.h>

#include "bench/clocks/table.h"
#include "bench/tool.h"

namespace flextip::bench {
namespace {

struct Arguments {
  std::uint64_t first_seed = 1;
  int seeds = 20;
  std::string motion = "all", state = "all";
  bool each = false;
};

void AddOptions(CLI::App& app, Arguments& a) {
  app.add_option("--first-seed", a.first_seed, "of the first session")->capture_default_str();
  app.add_option("--seeds", a.seeds, "sessions of each kind")->capture_default_str();
  app.add_option("--motion", a.motion, "fast, ordinary or all")
      ->check(CLI::IsMember({"fast", "ordinary", "all"}))
      ->capture_default_str();
  app.add_option("--state", a.state, "clean, effects or all")
      ->check(CLI::IsMember({"clean", "effects", "all"}))
      ->capture_default_str();
  app.add_flag("--each", a.each, "print a line for each stream of each session, on stderr");
}

void PrintRow(const ClockRow& row) {
  if (!row.found) {
    fmt::print(stderr, "{:8} refused: {}; {}\n", row.stream, row.reason, row.session);
    return;
  }
  fmt::print(stderr, "{:8} error {:9.3f} sd {:7.3f} ms z {:6.2f} zr {:6.2f}; {}\n", row.stream,
             1e3 * row.error_s, 1e3 * row.sd_s, row.error_s / row.sd_s,
             row.rate_error / row.rate_sd, row.session);
}

void Run(Arguments& a) {
  fmt::print("{}", MarkdownHead());
  for (const bool fast : {true, false}) {
    for (const bool effects : {false, true}) {
      if (a.motion != "all" && fast != (a.motion == "fast")) continue;
      if (a.state != "all" && effects != (a.state == "effects")) continue;
      std::vector<ClockRow> rows;
      for (int i = 0; i < a.seeds; ++i) {
        const ClockSession session = DrawSession({.fast = fast, .effects = effects},
                                                 a.first_seed + static_cast<std::uint64_t>(i));
        for (const ClockRow& row : MeasureSession(session)) {
          rows.push_back(row);
          if (a.each) PrintRow(row);
        }
      }
      fmt::print("{}", MarkdownLines(fmt::format("{}, {}", fast ? "fast" : "ordinary",
                                                 effects ? "effects" : "clean"),
                                     rows));
      std::fflush(stdout);
    }
  }
}

}  // namespace
}  // namespace flextip::bench

int main(int argc, char** argv) {
  using namespace flextip::bench;
  return RunTool(argc, argv, "How well clocks of sessions with known clocks are found", AddOptions,
                 Run);
}
