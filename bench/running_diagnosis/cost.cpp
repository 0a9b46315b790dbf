#include "bench/running_diagnosis/cost.h"

#include <fmt/format.h>

#include <algorithm>
#include <ctime>
#include <numeric>
#include <vector>

#include "bench/running_diagnosis/draw.h"
#include "diagnosis/running/running_diagnosis.h"
#include "pipeline/sensor_readings.h"

namespace flextip::bench {
namespace {

constexpr double kSeconds = 120.0, kAfforded_s = 200e-6;

double ThreadTime_s() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

}  // namespace

WatchCost MeasureCost(std::uint64_t seed) {
  WatchedRun run = DrawWatched(seed, 0, Suite::kAll, kSeconds, 0.1);
  run.setup.watch = nullptr;
  const simulation::LoopResult result = RunClosedLoop(run.setup, nullptr);
  const Recording& recording = result.recording;
  ShaftEstimator estimator(EstimatorOptionsFor(run.setup.base.instrument, run.setup.base.p_RP,
                                               run.setup.base.gravity_m_s2));
  diagnosis::RunningDiagnosis watch(run.setup.base);
  const ShaftChange none;
  std::vector<double> times_s;
  double estimates_s = 0.0;
  for (const auto& update : result.updates) {
    const auto z = MeasurementsAt(recording, update.t_ns);
    if (!z) continue;
    const double begin_s = ThreadTime_s();
    (void)estimator.Update(*z);
    const double between_s = ThreadTime_s();
    watch.Look({update.t_ns, *z, {update.t_ns, update.t_ns, update.t_ns, update.t_ns}, none});
    watch.Work();
    const double end_s = ThreadTime_s();
    estimates_s += between_s - begin_s;
    times_s.push_back(end_s - between_s);
  }
  std::sort(times_s.begin(), times_s.end());
  const auto count = static_cast<double>(times_s.size());
  WatchCost cost;
  cost.cycles = static_cast<int>(times_s.size());
  cost.mean_s = std::accumulate(times_s.begin(), times_s.end(), 0.0) / count;
  cost.p50_s = times_s[times_s.size() / 2];
  cost.above = static_cast<int>(times_s.end() -
                                std::upper_bound(times_s.begin(), times_s.end(), kAfforded_s));
  cost.p99_s = times_s[static_cast<std::size_t>(0.99 * (count - 1.0))];
  cost.worst_s = times_s.back();
  cost.estimate_mean_s = estimates_s / count;
  return cost;
}

std::string CostText(const WatchCost& cost) {
  return fmt::format(
      "a cycle of the running diagnosis: {:.0f} us in the mean, half below {:.0f}, 99 % below "
      "{:.0f}, "
      "worst {:.0f}, {} of {} above 200; {:.2f} times an estimate ({:.0f} us)\n",
      1e6 * cost.mean_s, 1e6 * cost.p50_s, 1e6 * cost.p99_s, 1e6 * cost.worst_s, cost.above,
      cost.cycles, cost.mean_s / cost.estimate_mean_s, 1e6 * cost.estimate_mean_s);
}

}  // namespace flextip::bench
