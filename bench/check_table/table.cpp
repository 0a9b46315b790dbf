#include "bench/check_table/table.h"

#include <fmt/format.h>

#include <algorithm>

#include "bench/check_table/draw.h"
#include "plausibility/check_recording.h"
#include "testdata/broken/broken_recording.h"

namespace flextip::bench {
namespace {

using plausibility::CheckResult;
using plausibility::Finding;
using plausibility::Severity;

std::vector<std::string> Described(const CheckResult& result) {
  std::vector<std::string> lines;
  for (const Finding& f : result.findings)
    lines.push_back(fmt::format("{} {}: {}", Name(f.severity), f.id, f.text));
  return lines;
}

void Count(const CheckResult& result, const std::string& base, WayRow& row) {
  bool named = false;
  int others = 0;
  for (const Finding& f : result.findings) {
    if (f.id == row.finding) {
      named = true;
    } else if (f.severity == Severity::kWrong) {
      ++others;
    }
  }
  ++row.recordings;
  row.named += named;
  row.others += others;
  if (named && others == 0) return;
  row.remarks.push_back(fmt::format("{}: {}", base, fmt::join(Described(result), "; ")));
}

}  // namespace

int CheckTable::Recordings() const {
  int sum = 0;
  for (const WayRow& row : ways) sum += row.recordings;
  return sum;
}

int CheckTable::Named() const {
  int sum = 0;
  for (const WayRow& row : ways) sum += row.named;
  return sum;
}

int CheckTable::Others() const {
  int sum = 0;
  for (const WayRow& row : ways) sum += row.others;
  return sum;
}

int CheckTable::HealthyWithFindings() const {
  return static_cast<int>(std::count_if(healthy.begin(), healthy.end(),
                                        [](const HealthyRow& r) { return !r.findings.empty(); }));
}

std::string CheckTable::Markdown() const {
  std::string text = "| broken so | finding | named | other wrong findings |\n|---|---|---|---|\n";
  for (const WayRow& row : ways) {
    text += fmt::format("| {} | `{}` | {} of {} | {} |\n", row.way, row.finding, row.named,
                        row.recordings, row.others);
  }
  text +=
      fmt::format("\nNamed: {} of {} ({:.1f} %) in {} ways; {} other wrong findings.\n", Named(),
                  Recordings(), 100.0 * Named() / std::max(1, Recordings()), ways.size(), Others());
  return text +
         fmt::format("Healthy: {} of {} with a finding.\n", HealthyWithFindings(), healthy.size());
}

CheckTable MeasureChecks(const CheckTableOptions& options,
                         const std::function<void(int done, int all)>& progress) {
  constexpr std::uint64_t kBroken = 500'000;  // seeds apart from those of the healthy ones
  CheckTable table;
  std::vector<broken::BrokenWay> ways = broken::BrokenWays();
  std::erase_if(ways, [&](const broken::BrokenWay& way) {
    return way.name.find(options.ways) == std::string::npos &&
           way.finding.find(options.ways) == std::string::npos;
  });
  const int all = options.healthy + options.bases + static_cast<int>(ways.size());
  int done = 0;
  for (int i = 0; i < options.healthy; ++i) {
    const HealthyCase drawn = DrawHealthy(options.seed + static_cast<std::uint64_t>(i));
    table.healthy.push_back({drawn.name, Described(plausibility::CheckRecording(drawn.recording))});
    progress(++done, all);
  }
  std::vector<HealthyCase> bases;
  for (int i = 0; i < options.bases; ++i) {
    bases.push_back(DrawHealthy(options.seed + kBroken + static_cast<std::uint64_t>(i)));
    progress(++done, all);
  }
  std::size_t next = 0;  // every way takes other recordings
  for (const broken::BrokenWay& way : ways) {
    WayRow row{way.name, way.finding, 0, 0, 0, {}};
    for (std::size_t tried = 0; tried < bases.size() && row.recordings < options.per_way; ++tried) {
      const HealthyCase& base = bases[next++ % bases.size()];
      if (!broken::Applies(way, base.recording, base.hung_mass)) continue;
      broken::Rng rng(options.seed + next);
      Count(plausibility::CheckRecording(broken::BreakRecording(base.recording, way, rng)),
            base.name, row);
    }
    table.ways.push_back(std::move(row));
    progress(++done, all);
  }
  return table;
}

}  // namespace flextip::bench
