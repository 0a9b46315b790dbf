#include "calibration/verdict/camera.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "calibration/camera/board_shape.h"

namespace flextip {
namespace {

constexpr double kManyRejected = 0.2;      // of the views
constexpr double kManyOutliers = 0.05;     // of the corners
constexpr double kMuchWorse = 1.3;         // held-out error over the one in sample
constexpr double kUncovered = 20.0;        // uncertainty at a border over that in the middle
constexpr double kBordersUnsure_px = 1.0;  // a whole pixel somewhere in the picture
constexpr double kUnsure = 10.0;           // uncertainty over the picture, of the corners' noise
constexpr double kOverconfident = 3.0;     // halves of the views differ by so many times the claim

constexpr const char* kUsers = "the commands on what this camera records";
constexpr const char* kUse =
    "flextip track recording --calibration RESULT/calibration.yaml -o recording-tracked";

void MentionNotFitting(std::size_t count, double all, double many, const std::string& noun,
                       CalibrationVerdict& verdict) {
  verdict.MentionCount(count, all, many, Counted(count, noun) + " did not fit and do not count");
}

void AddShape(const BoardShape& shape, CalibrationVerdict& verdict) {
  if (!(shape.sd_m > 0)) return;
  const auto [rms_m, longest_m] = SizeOf(shape);
  verdict.reasons.push_back(fmt::format(
      "the board is not as described: its corners are {:.3f} mm RMS off, {:.3f} mm at most, which "
      "was estimated with the rest",
      1e3 * rms_m, 1e3 * longest_m));
}

// The projection's uncertainty over the picture. `name`: "" or "cam0, ".
void AddUncertainty(const CameraUncertainty& u, const std::string& name, double noise_px,
                    CalibrationVerdict& verdict) {
  const double centre_px = u.near.CentrePx(), mean_px = u.near.MeanPx(),
               most_px = u.near.LargestPx();
  verdict.Add(name + fmt::format("uncertain at {:.0f} mm", 1e3 * u.near.depth_m),
              fmt::format("{:.2g} px in the middle, {:.2g} px on average", centre_px, mean_px));
  if (most_px > kUncovered * centre_px) {
    verdict.Mention(
        fmt::format("{}the borders of the picture were hardly covered: {:.2g} px there, {:.2g} px "
                    "in the middle",
                    name, most_px, centre_px),
        mean_px > kUnsure * noise_px || most_px > kBordersUnsure_px);
  }
  if (verdict.next.empty() && !u.next.empty()) {
    verdict.next = fmt::format("{} (the mean would fall from {:.3f} to {:.3f} px)", u.next[0].words,
                               u.next[0].before_px, u.next[0].after_px);
  }
}

}  // namespace

CalibrationVerdict JudgeCamera(const CameraCalibrationResult& r,
                               const std::optional<CameraUncertainty>& uncertainty,
                               const std::optional<ProjectionDifference>& split) {
  CalibrationVerdict verdict;
  const CameraCalibration& c = r.solution.camera;
  const auto sd = r.StandardDeviations();
  const double rms_px = r.solution.RmsPx();
  verdict.Add("focal lengths", fmt::format("{:.2f}, {:.2f} px", c.fu_px, c.fv_px),
              fmt::format("{:.2f}, {:.2f} px", sd[0], sd[1]));
  verdict.Add("principal point", fmt::format("{:.2f}, {:.2f} px", c.cu_px, c.cv_px),
              fmt::format("{:.2f}, {:.2f} px", sd[2], sd[3]));
  if (uncertainty) AddUncertainty(*uncertainty, "", r.solution.noise_px, verdict);
  verdict.Add("lens", LensModelOf(c).Name());
  verdict.Add("corners off by", fmt::format("{:.3f} px RMS", rms_px));
  verdict.Add("views held out", fmt::format("{:.3f} px RMS", r.heldout_rms_px));
  const double split_px = split ? split->rms_px : 0.0;
  if (split_px > 0) {
    verdict.Add("halves of the views differ by", fmt::format("{:.3f} px", split_px));
  }
  verdict.Add("views used", fmt::format("{} of {}", r.views_used, r.views.size()));

  MentionNotFitting(static_cast<std::size_t>(r.views_rejected), static_cast<double>(r.views.size()),
                    kManyRejected, "view", verdict);
  MentionNotFitting(static_cast<std::size_t>(r.solution.Outliers()), r.solution.CornersUsed(),
                    kManyOutliers, "corner", verdict);
  AddShape(r.solution.shape, verdict);
  if (r.heldout_rms_px > kMuchWorse * rms_px) {
    verdict.Beware("views that were held out fit much worse than the others: too few views");
  }
  if (uncertainty) {
    const double mean_px = uncertainty->near.MeanPx();
    // Two halves, each with twice the variance, in two directions.
    if (split_px > kOverconfident * 2.0 * std::sqrt(2.0) * mean_px) {
      verdict.Beware(
          fmt::format("lenses from half of the views each differ by {:.2f} px where "
                      "noise explains {:.2f} px: board or lens are not as modelled",
                      split_px, 2.0 * std::sqrt(2.0) * mean_px));
    }
  }
  verdict.says = fmt::format("{} Corners of views that it has not seen are {:.3f} px off.",
                             verdict.Judged(), r.heldout_rms_px);
  verdict.AdviseUse(kUsers, kUse);
  return verdict;
}

CalibrationVerdict JudgeStereo(const StereoResult& r,
                               const std::array<std::optional<CameraUncertainty>, 2>& uncertainty) {
  CalibrationVerdict verdict;
  verdict.Add("baseline", fmt::format("{:.3f} mm", 1e3 * r.baseline.length_m),
              fmt::format("{:.3f} mm", 1e3 * r.baseline.sd_m));
  const Eigen::VectorXd sd = r.PairCovariance().diagonal().cwiseSqrt();
  verdict.Add("cam1 in cam0, cam1.T_C0C1", PlaceText(r.solution.T_C0C1.p),
              fmt::format("{:.3f} mm and {:.3f}°", 1e3 * sd.tail<3>().norm(),
                          180 / M_PI * sd.head<3>().norm()));
  for (int eye = 0; eye < 2; ++eye) {
    if (!uncertainty[eye]) continue;
    AddUncertainty(*uncertainty[eye], fmt::format("cam{}, ", eye), r.solution.noise_px, verdict);
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
  MentionNotFitting(not_used, 2 * pairs, kManyRejected, "picture", verdict);
  AddShape(r.solution.shape, verdict);
  if (apart > 0) {
    verdict.Beware(Counted(apart, "pair") + " whose pictures are not of one moment, see below");
  }
  verdict.says = verdict.Judged() + " " + verdict.says;
  verdict.AdviseUse(kUsers, kUse);
  return verdict;
}

JudgedCamera CalibrateAndJudge(const CornersFile& corners,
                               const CameraCalibrationOptions& options) {
  const BoardSpec board = ParseBoardSpec(corners.board);
  JudgedCamera judged;
  judged.result =
      CalibrateCamera(corners.views, corners.width_px, corners.height_px, board, options);
  if (!judged.result.IsUsable()) return judged;
  judged.split = SplitViews(judged.result.solution);
  judged.uncertainty = FindUncertainty(judged.result.solution, BoardCorners(board));
  judged.verdict = JudgeCamera(judged.result, judged.uncertainty, judged.split);
  return judged;
}

JudgedStereo CalibrateAndJudge(const std::array<CornersFile, 2>& eyes,
                               const StereoOptions& options) {
  std::vector<StereoPair> pairs(std::min(eyes[0].views.size(), eyes[1].views.size()));
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    pairs[i].eyes = {eyes[0].views[i], eyes[1].views[i]};
  }
  const std::array<Eigen::Vector2i, 2> sizes_px{
      Eigen::Vector2i(eyes[0].width_px, eyes[0].height_px),
      Eigen::Vector2i(eyes[1].width_px, eyes[1].height_px)};
  JudgedStereo judged;
  judged.result = CalibrateStereo(pairs, sizes_px, ParseBoardSpec(eyes[0].board), options);
  if (!judged.result.IsUsable()) return judged;
  for (int eye = 0; eye < 2; ++eye) {
    judged.uncertainty[eye] = FindUncertainty(judged.result.solution, eye);
  }
  judged.verdict = JudgeStereo(judged.result, judged.uncertainty);
  return judged;
}

}  // namespace flextip
