#include "recording/tip_score.h"

#include <algorithm>
#include <cmath>

#include "core/linear_algebra.h"
#include "recording/streams/series_file.h"
#include "recording/text/csv.h"
#include "recording/truth.h"

namespace flextip {

std::optional<Series<Eigen::Vector3d>> ReadTipTruth(const std::filesystem::path& recording,
                                                    const std::filesystem::path& file) {
  Series<Eigen::Vector3d> truth;
  if (file.empty()) {
    const auto of_recording = ReadTruth(recording);
    if (!of_recording) return {};
    for (const auto& sample : *of_recording) truth.push_back({sample.t_ns, sample.value.p_RE});
    return truth;
  }
  ReadLog log;
  CsvReader csv(file, {kTimeColumn, "x", "y", "z"}, log, {.allow_other_columns = true});
  while (csv.Next()) {
    const TimeNs t_ns = csv.Integer(0);
    if (!truth.empty()) CheckTimeRuns(csv, truth.back().t_ns, t_ns);
    truth.push_back({t_ns, ReadVector3(csv, 1)});
  }
  if (truth.empty()) throw csv.Error("no samples, expected at least one whole line of data");
  return truth;
}

double TipScore::RmsError() const { return std::sqrt(squared_m2 / std::max(1, frames)); }
double TipScore::RmsDepth() const { return std::sqrt(squared_depth_m2 / std::max(1, frames)); }
double TipScore::RmsAcross() const {
  return std::sqrt(std::max(0.0, squared_m2 - squared_depth_m2) / std::max(1, frames));
}
double TipScore::MeanNees() const { return nees / std::max(1, frames); }
double TipScore::ShareInside() const { return static_cast<double>(inside) / std::max(1, frames); }

void TipScore::Add(const TipObservation& tip, const Eigen::Vector3d& p_RE, const Pose& T_RC) {
  constexpr double kChi2Of95Percent = 7.815;  // three degrees of freedom
  const Eigen::Vector3d e_R = tip.p_RE - p_RE;
  const double along = (T_RC.R.transpose() * e_R).z();
  const double normalised = MahalanobisSquared(e_R, tip.covariance_m2);
  squared_m2 += e_R.squaredNorm();
  squared_depth_m2 += along * along;
  nees += normalised;
  max_error_m = std::max(max_error_m, e_R.norm());
  inside += normalised <= kChi2Of95Percent;
  ++frames;
}

TipScore ScoreTips(const Series<TipObservation>& tips, const Series<Eigen::Vector3d>& truth,
                   const Pose& T_RC) {
  TipScore score;
  for (const auto& tip : tips) {
    const auto p_RE = ValueAt(truth, tip.t_ns);
    if (p_RE && tip.value.status == TipStatus::kOk) score.Add(tip.value, *p_RE, T_RC);
  }
  return score;
}

}  // namespace flextip
