#include "diagnosis/planning/tip_course.h"

#include <algorithm>
#include <cmath>

#include "core/check.h"
#include "diagnosis/planning/imagined_samples.h"

namespace flextip::diagnosis {
namespace {

/// How many times faster than the tip the wrist moves at most along a line of the tip. The part of
/// a motion across the shaft is turned about the port.
double WristOverTip(const Eigen::Vector3d& from, const Eigen::Vector3d& to,
                    const Eigen::Vector3d& p_RP, double length_m) {
  constexpr int kSteps = 16;
  const Eigen::Vector3d along = (to - from).normalized();
  double most = 0.0;
  for (int i = 0; i <= kSteps; ++i) {
    const Eigen::Vector3d to_tip = from + double(i) / kSteps * (to - from) - p_RP;
    const double inserted = to_tip.norm();
    const Eigen::Vector3d d = to_tip / inserted;
    const double axial = along.dot(d), lever = (length_m - inserted) / inserted;
    most = std::max(most, std::hypot(axial, lever * std::sqrt(std::max(0.0, 1.0 - axial * axial))));
  }
  return most;
}

}  // namespace

Workspace RecordedWorkspace(const SampleSet& recorded) {
  const Eigen::Vector3d axis = MeanShaftFrame(recorded).col(0);
  const double length = recorded.instrument.length_m;
  Workspace space{length, 0.0, 0.0};
  for (const DiagnosisSample& sample : recorded.samples) {
    const Eigen::Vector3d to_port = recorded.p_RP - sample.p_RW;
    const double inserted = length - to_port.norm();
    space.inserted_from_m = std::min(space.inserted_from_m, inserted);
    space.inserted_to_m = std::max(space.inserted_to_m, inserted);
    space.angle_rad =
        std::max(space.angle_rad, std::atan2(to_port.cross(axis).norm(), to_port.dot(axis)));
  }
  return space;
}

double RecordedSpeed(const SampleSet& recorded) {
  std::vector<double> speeds;
  for (std::size_t k = 1; k < recorded.samples.size(); ++k) {
    const auto &a = recorded.samples[k - 1], &b = recorded.samples[k];
    if (b.t_s > a.t_s) speeds.push_back((b.p_RW - a.p_RW).norm() / (b.t_s - a.t_s));
  }
  if (speeds.empty()) return 0.0;
  const auto high = speeds.begin() + std::ptrdiff_t(0.95 * double(speeds.size() - 1));
  std::nth_element(speeds.begin(), high, speeds.end());
  return *high;
}

Eigen::Vector3d StraightTip(const Eigen::Vector3d& p_RW, const Eigen::Vector3d& p_RP,
                            double length_m) {
  return p_RW + length_m * (p_RP - p_RW).normalized();
}

TipCourse::TipCourse(std::vector<Eigen::Vector3d> places, const Eigen::Vector3d& p_RP,
                     double length_m, double most_speed_m_s)
    : places_(std::move(places)), p_RP_(p_RP), length_m_(length_m) {
  FLEXTIP_CHECK(places_.size() >= 2, "a course has a start and an end");
  FLEXTIP_CHECK(most_speed_m_s > 0.0, "a course has a speed");
  double faster = 1.0;
  for (std::size_t i = 1; i < places_.size(); ++i)
    faster = std::max(faster, WristOverTip(places_[i - 1], places_[i], p_RP, length_m));
  speed_m_s_ = most_speed_m_s / faster;
  ends_s_.push_back(0.0);
  for (std::size_t i = 1; i < places_.size(); ++i)
    ends_s_.push_back(ends_s_.back() + (places_[i] - places_[i - 1]).norm() / speed_m_s_);
}

Eigen::Vector3d TipCourse::Tip(double t_s) const {
  const auto after = std::upper_bound(ends_s_.begin(), ends_s_.end(), t_s);
  if (after == ends_s_.begin()) return places_.front();
  if (after == ends_s_.end()) return places_.back();
  const auto i = std::size_t(after - ends_s_.begin());
  const double part = (t_s - ends_s_[i - 1]) / (ends_s_[i] - ends_s_[i - 1]);
  return places_[i - 1] + part * (places_[i] - places_[i - 1]);
}

std::vector<Eigen::Vector3d> TipCourse::PlacesUntil(double t_s) const {
  std::vector<Eigen::Vector3d> places;
  for (std::size_t i = 0; i < places_.size() && ends_s_[i] < t_s; ++i) places.push_back(places_[i]);
  places.push_back(Tip(t_s));
  return places;
}

Eigen::Vector3d TipCourse::Wrist(double t_s) const {
  const Eigen::Vector3d tip = Tip(t_s);
  return tip + length_m_ * (p_RP_ - tip).normalized();
}

}  // namespace flextip::diagnosis
