#include "pipeline/estimate_recording.h"

#include "pipeline/sensor_readings.h"

namespace flextip {

Series<ShaftEstimate> EstimateRecording(
    const Recording& recording, InstrumentEstimator& estimator, InstrumentModel* model,
    const std::function<void(std::size_t, std::size_t)>& progress) {
  const std::vector<TimeNs> times = EstimationTimes(recording);
  Series<ShaftEstimate> estimates;
  Eigen::Vector3d f_tip_N = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < times.size(); ++i) {
    if (progress) progress(i, times.size());
    const auto measured = MeasurementsAt(recording, times[i]);
    if (!measured) continue;
    if (model != nullptr) {
      model->Advance(times[i], *measured, f_tip_N);
      estimates.push_back({times[i], estimator.Update(model->Correct(*measured), model->Shaft())});
      AddLengthDoubt(*model, estimates.back().value);
    } else {
      estimates.push_back({times[i], estimator.Update(*measured)});
    }
    f_tip_N = estimates.back().value.model.f_tip_N;
  }
  return estimates;
}

}  // namespace flextip
