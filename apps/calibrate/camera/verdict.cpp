#include "apps/calibrate/camera/verdict.h"

#include <fmt/format.h>

#include <cmath>

#include "apps/calibrate/camera/board_shape_output.h"

namespace flextip {
namespace {

using nlohmann::json;

constexpr double kManyRejected = 0.2;   // of the views
constexpr double kManyOutliers = 0.05;  // of the corners
constexpr double kMuchWorse = 1.3;      // held-out error over the one in sample
constexpr double kUncovered = 20.0;     // uncertainty at a border over that in the middle
constexpr double kUnsure = 10.0;        // uncertainty over the picture, of the corners' noise
constexpr double kOverconfident = 3.0;  // halves of the views differ by so many times the claim

std::string Judged(const CalibrationVerdict& verdict) {
  return verdict.grade == CalibrationGrade::kGood ? "Good." : "To be used with care.";
}

void ReasonOfCount(std::size_t count, double all, double many, const std::string& what,
                   CalibrationVerdict& verdict) {
  if (count == 0) return;
  const std::string text = Counted(count, what) + " did not fit and do not count";
  if (static_cast<double>(count) > many * all) {
    verdict.Beware(text);
  } else {
    verdict.reasons.push_back(text);
  }
}

void AddShape(const BoardShape& shape, CalibrationVerdict& verdict) {
  const std::string text = BoardShapeText(shape);
  if (!text.empty()) verdict.reasons.push_back(text);
}

// What the map of the projection says, of the camera under `camera`.
void AddUncertaintyOf(const json& camera, const std::string& name, double noise_px,
                      CalibrationVerdict& verdict) {
  const json* u =
      camera.contains("projection_uncertainty") ? &camera["projection_uncertainty"] : nullptr;
  if (u == nullptr) return;
  const json& near = (*u)["at_working_distance"];
  const double centre_px = near["centre_px"], mean_px = near["mean_px"],
               most_px = near["largest_px"];
  verdict.Add(
      name + fmt::format("uncertain at {:.0f} mm", 1e3 * (*u)["working_distance_m"].get<double>()),
      fmt::format("{:.2g} px in the middle, {:.2g} px on average", centre_px, mean_px));
  if (most_px > kUncovered * centre_px) {
    const std::string text = fmt::format(
        "{}the borders of the picture were hardly covered: {:.2g} px there, {:.2g} px in the "
        "middle",
        name, most_px, centre_px);
    if (mean_px > kUnsure * noise_px) {
      verdict.Beware(text);
    } else {
      verdict.reasons.push_back(text);
    }
  }
  const json& next = (*u)["next_views"];
  if (verdict.next.empty() && !next.empty()) {
    verdict.next = fmt::format(
        "{} (the mean would fall from {:.3f} to {:.3f} px)", next[0]["do"].get<std::string>(),
        next[0]["mean_px_before"].get<double>(), next[0]["mean_px_after"].get<double>());
  }
}

}  // namespace

CalibrationVerdict CameraVerdict(const CameraCalibrationResult& r, const json& summary) {
  CalibrationVerdict verdict;
  const CameraCalibration& c = r.solution.camera;
  const auto sd = r.StandardDeviations();
  const double rms_px = r.solution.RmsPx();
  verdict.Add("focal lengths", fmt::format("{:.2f}, {:.2f} px", c.fu_px, c.fv_px),
              fmt::format("{:.2f}, {:.2f} px", sd[0], sd[1]));
  verdict.Add("principal point", fmt::format("{:.2f}, {:.2f} px", c.cu_px, c.cv_px),
              fmt::format("{:.2f}, {:.2f} px", sd[2], sd[3]));
  AddUncertaintyOf(summary, "", r.solution.noise_px, verdict);
  verdict.Add("lens", summary.value("lens", ""));
  verdict.Add("corners off by", fmt::format("{:.3f} px RMS", rms_px));
  verdict.Add("views held out", fmt::format("{:.3f} px RMS", r.heldout_rms_px));
  const double split_px = summary.value("split_views_rms_px", 0.0);
  if (split_px > 0)
    verdict.Add("halves of the views differ by", fmt::format("{:.3f} px", split_px));
  verdict.Add("views used", fmt::format("{} of {}", r.views_used, r.views.size()));

  ReasonOfCount(static_cast<std::size_t>(r.views_rejected), static_cast<double>(r.views.size()),
                kManyRejected, "view", verdict);
  ReasonOfCount(static_cast<std::size_t>(r.solution.Outliers()), r.solution.CornersUsed(),
                kManyOutliers, "corner", verdict);
  AddShape(r.solution.shape, verdict);
  if (r.heldout_rms_px > kMuchWorse * rms_px) {
    verdict.Beware("views that were held out fit much worse than the others: too few views");
  }
  if (summary.contains("projection_uncertainty")) {
    const double mean_px =
        summary["projection_uncertainty"]["at_working_distance"]["mean_px"].get<double>();
    // Two halves, each with twice the variance, in two directions.
    if (split_px > kOverconfident * 2.0 * std::sqrt(2.0) * mean_px) {
      verdict.Beware(
          fmt::format("lenses from half of the views each differ by {:.2f} px where "
                      "noise explains {:.2f} px: board or lens are not as modelled",
                      split_px, 2.0 * std::sqrt(2.0) * mean_px));
    }
  }
  verdict.says = fmt::format("{} Corners of views that it has not seen are {:.3f} px off.",
                             Judged(verdict), r.heldout_rms_px);
  return verdict;
}

CalibrationVerdict StereoVerdict(const StereoResult& r, const json& summary) {
  CalibrationVerdict verdict;
  verdict.Add("baseline", fmt::format("{:.3f} mm", 1e3 * r.baseline.length_m),
              fmt::format("{:.3f} mm", 1e3 * r.baseline.sd_m));
  const Eigen::VectorXd sd = r.PairCovariance().diagonal().cwiseSqrt();
  verdict.Add("cam1 in cam0, cam1.T_C0C1", PlaceText(r.solution.T_C0C1.p),
              fmt::format("{:.3f} mm and {:.3f}°", 1e3 * sd.tail<3>().norm(),
                          180 / M_PI * sd.head<3>().norm()));
  for (const char* name : {"cam0", "cam1"}) {
    AddUncertaintyOf(summary.value(name, json::object()), std::string(name) + ", ",
                     r.solution.noise_px, verdict);
  }
  verdict.Add("corners off by", fmt::format("{:.3f} px RMS", r.solution.RmsPx()));
  verdict.Add("rows differ by", fmt::format("{:.3f} px RMS", r.epipolar_rms_px));
  verdict.says = "The corners are " + fmt::format("{:.3f} px off.", r.solution.RmsPx());
  if (r.heldout) {
    verdict.Add("pairs held out", fmt::format("{:.3f} px, rows {:.3f} px", r.heldout->rms_px,
                                              r.heldout->epipolar_rms_px));
    verdict.Add("lengths held out", fmt::format("{:.3f} mm RMS", 1e3 * r.heldout->length_rms_m));
    verdict.says = fmt::format(
        "Distances between corners of pairs that it has not seen come out to {:.3f} mm, the "
        "baseline to {:.3f} mm.",
        1e3 * r.heldout->length_rms_m, 1e3 * r.baseline.sd_m);
    if (r.heldout->rms_px > kMuchWorse * r.solution.RmsPx()) {
      verdict.Beware("pairs that were held out fit much worse than the others: too few pairs");
    }
  }
  verdict.Add("pairs used", fmt::format("{} of {}, {} single views", r.pairs_used, r.pairs.size(),
                                        r.single_views_used));
  std::size_t apart = 0, not_used = 0;
  for (const StereoPairResult& pair : r.pairs) {
    apart += pair.apart.empty() ? 0 : 1;
    for (const std::string& reason : pair.reasons) not_used += reason.empty() ? 0 : 1;
  }
  const auto pairs = static_cast<double>(r.pairs.size());
  ReasonOfCount(not_used, 2 * pairs, kManyRejected, "picture", verdict);
  AddShape(r.solution.shape, verdict);
  if (apart > 0) {
    verdict.Beware(Counted(apart, "pair") + " whose pictures are not of one moment, see below");
  }
  verdict.says = Judged(verdict) + " " + verdict.says;
  return verdict;
}

}  // namespace flextip
