#include "diagnosis/samples/outliers.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/median.h"

namespace flextip::diagnosis {
namespace {

constexpr int kHalf = 3;         // readings on either side
constexpr double kApart = 8.0;   // standard deviations
constexpr double kToSd = 1.483;  // from the median of absolute deviations, of a normal
constexpr double kLongestPeriod_s = 0.2;

using Window = std::array<double, 2 * kHalf + 1>;

Window Around(const Eigen::MatrixXd& readings, Eigen::Index k, Eigen::Index column) {
  Window window;
  for (int i = -kHalf; i <= kHalf; ++i) window[i + kHalf] = readings(k + i, column);
  std::array<double, kHalf> slopes;
  for (int i = 1; i <= kHalf; ++i)
    slopes[i - 1] = (window[kHalf + i] - window[kHalf - i]) / (2.0 * i);
  const double slope = Median(slopes);
  for (int i = -kHalf; i <= kHalf; ++i) window[i + kHalf] -= slope * i;
  return window;
}

struct Deviation {
  double of_middle = 0.0, of_window = 0.0;
};

Deviation DeviationAt(const Eigen::MatrixXd& readings, Eigen::Index k, Eigen::Index column) {
  Window window = Around(readings, k, column);
  const double median = Median(window);
  for (double& value : window) value = std::abs(value - median);
  const double of_middle = window[kHalf];
  return {of_middle, kToSd * Median(window)};
}

/// Takes the readings that stand apart out of a stream. `values` of one reading has the columns
/// that `noise` has.
template <class T, class Values>
void Clean(const char* name, Series<T>& series, const Eigen::VectorXd& noise, Values values,
           std::vector<std::string>& warnings) {
  if (series.size() <= 2 * kHalf) return;
  const double span_s = double(series.back().t_ns - series.front().t_ns) * 1e-9;
  if (span_s > kLongestPeriod_s * double(series.size() - 1)) return;
  Eigen::MatrixXd readings(Eigen::Index(series.size()), noise.size());
  for (std::size_t k = 0; k < series.size(); ++k)
    readings.row(Eigen::Index(k)) = values(series[k].value).transpose();
  const std::vector<bool> apart = StandApart(readings, noise);
  const auto count = std::count(apart.begin(), apart.end(), true);
  if (count == 0) return;
  Series<T> kept;
  for (std::size_t k = 0; k < series.size(); ++k)
    if (!apart[k]) kept.push_back(series[k]);
  warnings.push_back(
      fmt::format("{}: {} of {} readings stand apart from those around them: left out", name, count,
                  series.size()));
  series = std::move(kept);
}

Eigen::VectorXd Noise(int positions, double of_position, int directions, double of_direction) {
  Eigen::VectorXd noise(positions + directions);
  noise << Eigen::VectorXd::Constant(positions, of_position),
      Eigen::VectorXd::Constant(directions, of_direction);
  return noise;
}

Eigen::VectorXd PositionAndDirection(const Eigen::Vector3d& p, const Eigen::Vector3d& d) {
  Eigen::VectorXd values(6);
  values << p, d;
  return values;
}

void CleanEm(const char* name, std::optional<EmStream>& em, std::vector<std::string>& warnings) {
  if (!em) return;
  const auto values = [](const EmSample& s) {
    return PositionAndDirection(s.p_RS, s.q_RS * Eigen::Vector3d::UnitX());
  };
  Clean(name, em->samples, Noise(3, em->position_noise_m, 3, em->orientation_noise_rad), values,
        warnings);
}

void CleanVision(VisionStream& vision, std::vector<std::string>& warnings) {
  std::erase_if(vision.tips, [](const auto& tip) { return tip.value.status != TipStatus::kOk; });
  if (vision.tips.empty()) return;
  double variance = 0.0;
  for (const auto& tip : vision.tips)
    variance = std::max(variance, tip.value.covariance_m2.diagonal().maxCoeff());
  const auto values = [](const TipObservation& tip) {
    return PositionAndDirection(tip.p_RE, tip.d_RE.value_or(Eigen::Vector3d::Zero()));
  };
  Clean("vision0", vision.tips, Noise(3, std::sqrt(variance), 3, vision.direction_noise_rad),
        values, warnings);
}

}  // namespace

std::vector<bool> StandApart(const Eigen::MatrixXd& readings, const Eigen::VectorXd& noise) {
  const Eigen::Index n = readings.rows();
  std::vector<bool> apart(std::size_t(n), false);
  if (n <= 2 * kHalf) return apart;
  for (Eigen::Index column = 0; column < readings.cols(); ++column) {
    std::vector<Deviation> deviations;
    std::vector<double> sizes;
    for (Eigen::Index k = kHalf; k < n - kHalf; ++k) {
      deviations.push_back(DeviationAt(readings, k, column));
      sizes.push_back(deviations.back().of_middle);
    }
    const double floor = std::max(noise[column], kToSd * Median(sizes));
    for (std::size_t i = 0; i < deviations.size(); ++i) {
      const double sd = std::max(floor, deviations[i].of_window);
      if (deviations[i].of_middle > kApart * sd) apart[i + kHalf] = true;
    }
  }
  return apart;
}

Recording WithoutOutliers(Recording recording, std::vector<std::string>& warnings) {
  const auto itself = [](const auto& value) { return value; };
  if (recording.wrist0) {
    const WristStream& wrist = *recording.wrist0;
    const Eigen::VectorXd noise = Noise(3, wrist.position_noise_m, 3, wrist.orientation_noise_rad);
    const auto values = [](const WristSample& s) {
      const Eigen::Vector3d x = Eigen::Vector3d::UnitX();
      return PositionAndDirection(s.p_RW, s.q_RW ? Eigen::Vector3d(*s.q_RW * x) : x);
    };
    Clean("wrist0", recording.wrist0->samples, noise, values, warnings);
  }
  CleanEm("em0", recording.em0, warnings);
  CleanEm("em1", recording.em1, warnings);
  if (recording.strain0) {
    Clean("strain0", recording.strain0->moments_Nm,
          Noise(4, recording.strain0->moment_noise_Nm, 0, 0.0), itself, warnings);
  }
  if (recording.vision0) CleanVision(*recording.vision0, warnings);
  if (recording.load0) {
    Clean("load0", recording.load0->f_tip_N, Noise(3, recording.load0->force_noise_N, 0, 0.0),
          itself, warnings);
  }
  return recording;
}

}  // namespace flextip::diagnosis
