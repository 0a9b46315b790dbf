#include <cmath>
#include <numeric>

#include "reproduction/chapter4/parts.h"

namespace flextip::reproduction {

const std::array<Eigen::Vector3d, 4> kCh4Moves = {
    Eigen::Vector3d(0.01, 0, 0), Eigen::Vector3d(-0.01, 0, 0), Eigen::Vector3d(0, 0.01, 0),
    Eigen::Vector3d(0, -0.01, 0)};

Instrument Ch4Rod() { return {0.6, 0.00238, 0.304, 0.0}; }

report::FigureTrace PathTrace(const std::vector<Eigen::Vector3d>& path,
                              const Eigen::Vector3d& origin) {
  report::FigureTrace trace;
  for (const Eigen::Vector3d& p : path) {
    trace.x.push_back(1e3 * (p - origin).x());
    trace.y.push_back(1e3 * (p - origin).y());
  }
  return trace;
}

MeanSd MeanAndSd(const std::vector<double>& values) {
  if (values.empty()) return {};
  const double n = static_cast<double>(values.size());
  MeanSd result;
  result.mean = std::accumulate(values.begin(), values.end(), 0.0) / n;
  double sum2 = 0.0;
  for (const double v : values) sum2 += (v - result.mean) * (v - result.mean);
  result.sd = n > 1.0 ? std::sqrt(sum2 / (n - 1.0)) : 0.0;
  return result;
}

ChapterResult ReproduceChapter4(const ReproduceOptions& options, const ChapterProgress& progress) {
  return InParts({{Ch4Simulation, 0.5}, {Ch4Experiment, 0.1}, {Ch4Indentation, 0.4}}, options,
                 progress);
}

}  // namespace flextip::reproduction
