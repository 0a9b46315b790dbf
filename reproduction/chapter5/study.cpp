#include "reproduction/chapter5/study.h"

#include <tbb/parallel_for.h>

#include <mutex>

namespace flextip::reproduction {
namespace {

OperatorResult RunOne(const StudyGroup& group, int number, std::uint64_t seed) {
  TrialSetup setup = group.setup;
  const int place = group.position >= 0 ? PlaceInOrder(number, group.position) : 4;
  setup.operator_seed = seed * 1000 + static_cast<std::uint64_t>(number);
  setup.noise_seed = setup.operator_seed * 10 + static_cast<std::uint64_t>(place);
  const TrialPlaces places;
  Trial trial = RunTrial(setup, places);
  OperatorResult result;
  result.recorded = MeasureIncursion(trial.recorded, places.WallX(), group.outline);
  result.truth = MeasureIncursion(trial.tips, places.WallX(), group.outline);
  result.worst_m = -places.wall_depth_m;
  for (const auto& p : trial.tips)
    result.worst_m = std::max(result.worst_m, p.x() - places.WallX());
  result.max_flexion_m = trial.max_flexion_m;
  result.rms_flexion_m = trial.rms_flexion_m;
  result.rms_side_force_N = trial.rms_side_force_N;
  result.max_side_force_N = trial.max_side_force_N;
  result.max_push_N = trial.max_push_N;
  result.cut_part = trial.cut_part;
  result.straight_part = trial.straight_part;
  result.no_tip_part = trial.no_tip_part;
  result.lost = trial.lost;
  result.rate_hz = trial.rate_hz;
  if (group.keep_paths) result.recorded_path = std::move(trial.recorded);
  return result;
}

}  // namespace

int PlaceInOrder(int operator_number, int condition) {
  constexpr int kOrders[4][4] = {{0, 1, 3, 2}, {1, 2, 0, 3}, {2, 3, 1, 0}, {3, 0, 2, 1}};
  const int(&order)[4] = kOrders[operator_number % 4];
  for (int place = 0; place < 4; ++place) {
    if (order[place] == condition) return place;
  }
  return -1;
}

MeanSd GroupResult::Of(const std::function<double(const OperatorResult&)>& value) const {
  std::vector<double> values;
  for (const auto& one : operators) values.push_back(value(one));
  return MeanSdOf(values);
}

std::vector<GroupResult> RunStudy(const std::vector<StudyGroup>& groups, std::uint64_t seed,
                                  const std::function<void(double done)>& progress) {
  std::vector<GroupResult> results;
  std::vector<std::pair<std::size_t, int>> jobs;
  for (std::size_t i = 0; i < groups.size(); ++i) {
    results.push_back({groups[i], std::vector<OperatorResult>(groups[i].operators)});
    for (int number = 0; number < groups[i].operators; ++number) jobs.emplace_back(i, number);
  }
  std::mutex mutex;
  std::size_t done = 0;
  tbb::parallel_for(
      tbb::blocked_range<std::size_t>(0, jobs.size(), 1),
      [&](const tbb::blocked_range<std::size_t>& range) {
        for (std::size_t job = range.begin(); job != range.end(); ++job) {
          const auto [i, number] = jobs[job];
          results[i].operators[number] = RunOne(groups[i], number, seed);
          const std::lock_guard<std::mutex> lock(mutex);
          progress(static_cast<double>(++done) / static_cast<double>(jobs.size()));
        }
      },
      tbb::simple_partitioner());
  return results;
}

}  // namespace flextip::reproduction
