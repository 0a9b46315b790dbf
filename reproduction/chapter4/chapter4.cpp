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

ChapterResult ReproduceChapter4(const ReproduceOptions& options, const ChapterProgress& progress) {
  return InParts({{Ch4Simulation, 0.5}, {Ch4Experiment, 0.1}, {Ch4Indentation, 0.4}}, options,
                 progress);
}

}  // namespace flextip::reproduction
