// How often flextip check names what is wrong with a recording, and what it finds in healthy ones.
#include <fmt/format.h>
#include <unistd.h>

#include "bench/check_table/table.h"
#include "bench/tool.h"

namespace flextip::bench {
namespace {

struct Arguments {
  CheckTableOptions options;
  bool remarks = false;
};

void AddOptions(CLI::App& app, Arguments& a) {
  app.add_option("--seed", a.options.seed, "of the first recording")->capture_default_str();
  app.add_option("--healthy", a.options.healthy, "healthy recordings")->capture_default_str();
  app.add_option("--bases", a.options.bases, "recordings that are broken")->capture_default_str();
  app.add_option("--per-way", a.options.per_way, "recordings broken in each way")
      ->capture_default_str();
  app.add_option("--ways", a.options.ways, "only those with this text in their name or finding");
  app.add_flag("--remarks", a.remarks, "print the findings of each that was not as it should be");
}

void Run(Arguments& a) {
  const CheckTable table = MeasureChecks(a.options, [](int done, int all) {
    if (isatty(STDERR_FILENO)) fmt::print(stderr, "\r{} of {}", done, all);
  });
  fmt::print("{}", table.Markdown());
  if (!a.remarks) return;
  for (const HealthyRow& row : table.healthy)
    if (!row.findings.empty())
      fmt::print("\nhealthy {}\n  {}\n", row.name, fmt::join(row.findings, "\n  "));
  for (const WayRow& row : table.ways)
    for (const std::string& remark : row.remarks) fmt::print("\n{}\n  {}\n", row.way, remark);
}

}  // namespace
}  // namespace flextip::bench

int main(int argc, char** argv) {
  using namespace flextip::bench;
  return RunTool(argc, argv, "How often flextip check names what is wrong", AddOptions, Run);
}
