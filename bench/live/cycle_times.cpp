// What the cycles of a recorded session take: each one run again, from its samples to its command,
// without sources, sockets and recorder.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <map>

#include "bench/tool.h"
#include "live/recorder/cycle_table.h"
#include "live/recorder/replay.h"

namespace flextip::bench {
namespace {

struct Arguments {
  std::filesystem::path recording;
  int repeats = 5;
};

/// What was new to a cycle since the one before.
enum class News : std::uint8_t { kNothing, kSensors, kTip };
constexpr const char* kNames[] = {"nothing new", "a new sample", "a new tip"};

using Times = std::vector<double>;  // us

std::vector<live::CycleRecord> Read(const std::filesystem::path& recording) {
  ReadLog log;
  live::CycleTableReader table(recording / "session0" / "cycles.csv", log);
  std::vector<live::CycleRecord> records;
  while (auto record = table.Next()) records.push_back(std::move(*record));
  return records;
}

/// Which of the readings changed from `a` to `b`.
News NewsOf(const SensorReadings& a, const SensorReadings& b) {
  const auto changed = [](const auto& was, const auto& is) {
    return is && (!was || was->t_ns != is->t_ns);
  };
  if (changed(a.tip, b.tip)) return News::kTip;
  const bool sensors = changed(a.wrist, b.wrist) || changed(a.em0, b.em0) ||
                       changed(a.em1, b.em1) || changed(a.strain, b.strain) ||
                       changed(a.load, b.load);
  return sensors ? News::kSensors : News::kNothing;
}

void Print(const char* name, Times times) {
  if (times.empty()) return;
  std::sort(times.begin(), times.end());
  const auto part = [&](double p) {
    return times[static_cast<std::size_t>(p * static_cast<double>(times.size() - 1))];
  };
  double sum = 0.0;
  for (const double time : times) sum += time;
  fmt::print(
      "{:14} {:7} cycles  mean {:6.1f}  p50 {:6.1f}  p99 {:6.1f}  p99.9 {:6.1f}  worst "
      "{:6.1f} us\n",
      name, times.size(), sum / static_cast<double>(times.size()), part(0.5), part(0.99),
      part(0.999), times.back());
}

/// Runs all cycles `repeats` times; takes the least time of each, as of an idle machine.
void Run(Arguments& a) {
  const live::Session session = live::RecordedSession(a.recording);
  const std::vector<live::CycleRecord> records = Read(a.recording);
  Times least(records.size(), 1e9);
  std::vector<News> news(records.size(), News::kNothing);
  for (int repeat = 0; repeat < a.repeats; ++repeat) {
    const auto cycle = live::CycleAtBegin(a.recording, session);
    SensorReadings last;
    for (std::size_t i = 0; i < records.size(); ++i) {
      const live::CycleInputs& inputs = records[i].inputs;
      const auto begin = std::chrono::steady_clock::now();
      cycle->Step(inputs);
      const auto end = std::chrono::steady_clock::now();
      least[i] = std::min(least[i], 1e-3 * static_cast<double>((end - begin).count()));
      const SensorReadings readings = cycle->Readings(inputs.streams);
      news[i] = NewsOf(last, readings);
      last = readings;
    }
  }
  std::map<News, Times> by_news;
  for (std::size_t i = 0; i < records.size(); ++i) by_news[news[i]].push_back(least[i]);
  Print("all", least);
  for (const auto& [kind, times] : by_news) Print(kNames[static_cast<int>(kind)], times);
}

void AddOptions(CLI::App& app, Arguments& a) {
  app.add_option("RECORDING", a.recording, "By flextip control")->required();
  app.add_option("--repeats", a.repeats, "The least of so many runs counts")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.footer("Example:\n  flextip_cycle_times out/live\n");
}

}  // namespace
}  // namespace flextip::bench

int main(int argc, char** argv) {
  return flextip::bench::RunTool(argc, argv, "What the cycles of a recorded session take",
                                 flextip::bench::AddOptions, flextip::bench::Run);
}
