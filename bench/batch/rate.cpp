// How many empty items a second: by one machine's pool, or over the ranks of mpirun.
#include <fmt/format.h>
#include <sys/resource.h>

#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "batch/ranks.h"
#include "batch/records.h"
#include "batch/run.h"
#include "bench/tool.h"

namespace flextip::bench {
namespace {

struct Arguments {
  int items = 5000, jobs = 1, megabytes = 0;
  std::filesystem::path records;
};

void AddOptions(CLI::App& app, Arguments& a) {
  app.add_option("--items", a.items, "Empty items")->check(CLI::PositiveNumber);
  app.add_option("--jobs", a.jobs, "At a time, of each rank")->check(CLI::PositiveNumber);
  app.add_option("--megabytes", a.megabytes, "Memory in use where items are forked from")
      ->check(CLI::NonNegativeNumber);
  app.add_option("--records", a.records,
                 "File of the items' ends, made anew; rank 0 waits for the disk");
  app.footer("Examples:\n  flextip_batch_rate --jobs 2\n  mpirun -n 3 flextip_batch_rate\n");
}

/// Processor time of this process alone: not of the one that forks, nor of the items.
double OwnSeconds() {
  rusage use{};
  getrusage(RUSAGE_SELF, &use);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return seconds(use.ru_utime) + seconds(use.ru_stime);
}

void Run(Arguments& a) {
  const std::vector<char> memory(static_cast<std::size_t>(a.megabytes) << 20, 'x');
  const auto nothing = [](const batch::Item&, std::string&) { return 0; };
  batch::Pool pool(nothing, {.jobs = a.jobs});
  std::optional<batch::Ranks> ranks;
  if (batch::IsRank()) ranks.emplace();
  if (batch::RankNumber() > 0) return ranks->Serve(pool, {}, {});
  std::vector<batch::Item> items;
  for (int i = 0; i < a.items; ++i) items.push_back({fmt::format("item{}", i), {}, 0.0});
  const double before_s = OwnSeconds();
  const auto begin = std::chrono::steady_clock::now();
  std::size_t ended = 0;
  std::optional<batch::Records> records;
  if (!a.records.empty()) {
    std::filesystem::remove(a.records);
    records.emplace(a.records);
  }
  const batch::Done count = [&](const std::vector<batch::Ended>& some) {
    ended += some.size();
    if (records) records->Add(some);
  };
  if (ranks) {
    ranks->RunItems(pool, items, count, {});
  } else {
    RunItems(pool, items, count);
  }
  const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - begin;
  const double own_s = OwnSeconds() - before_s, n = static_cast<double>(ended);
  fmt::print("{} empty items: {:.0f} a second, {:.3f} ms each\n", ended, n / wall.count(),
             1e3 * wall.count() / n);
  fmt::print("processor time of handing out: {:.1f} us an item, so at most {:.0f} items a second\n",
             1e6 * own_s / n, n / own_s);
}

}  // namespace
}  // namespace flextip::bench

int main(int argc, char** argv) {
  return flextip::bench::RunTool(argc, argv, "Empty items a second", flextip::bench::AddOptions,
                                 flextip::bench::Run);
}
