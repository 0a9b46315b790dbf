#include "apps/calibrate/hand_eye/output.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "apps/calibrate/verdict_json.h"
#include "apps/common/drawing.h"
#include "recording/text/csv.h"
#include "recording/text/text.h"
#include "report/figure.h"

namespace flextip {
namespace {

using Json = nlohmann::json;
constexpr double kDegrees = 180.0 / M_PI;

Json NumberOrNull(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

// Root of the trace of an entry's rotation and position, in deg and mm.
Json Deviations(const Calibration& calibration) {
  Json all = Json::object();
  for (const auto& entry : calibration.poses) {
    const Eigen::MatrixXd C = calibration.CovarianceOf(entry.first);
    all[entry.first] = {{"orientation_sd_deg", kDegrees * std::sqrt(C.topLeftCorner(3, 3).trace())},
                        {"position_sd_mm", 1e3 * std::sqrt(C.bottomRightCorner(3, 3).trace())}};
  }
  for (const auto& entry : calibration.numbers) {
    const Eigen::MatrixXd C = calibration.CovarianceOf(entry.first);
    Json sds = Json::array();
    for (Eigen::Index i = 0; i < C.rows(); ++i) sds.push_back(std::sqrt(C(i, i)));
    all[entry.first] = {{"value", entry.second}, {"sd", sds}};
  }
  return all;
}

Json Views(const HandEyeResult& result) {
  Json views = Json::array();
  for (const HandEyeViewResult& v : result.views) {
    views.push_back({{"view", v.name},
                     {"used", v.used},
                     {"reason", v.reason},
                     {"corners", v.corners},
                     {"board_rms_px", v.board_px},
                     {"rms_px", NumberOrNull(v.px)},
                     {"rms_mm", NumberOrNull(v.mm)},
                     {"heldout_rms_px", NumberOrNull(v.held_out_px)},
                     {"heldout_rms_mm", NumberOrNull(v.held_out_mm)},
                     {"chi2", v.chi2},
                     {"flipped", v.flipped}});
  }
  return views;
}

Json Motions(const HandEyeResult& result) {
  Json motions = Json::array();
  for (const HandEyeMotion& m : result.motions) {
    motions.push_back({{"motion", m.words},
                       {"point_sd_before_mm", 1e3 * m.sd_before_m},
                       {"point_sd_after_mm", 1e3 * m.sd_after_m}});
  }
  return motions;
}

// What the views' names do not have in common, at both ends.
std::vector<std::string> ShortNames(const HandEyeResult& result) {
  std::vector<std::string> names;
  for (const HandEyeViewResult& v : result.views) names.push_back(v.name);
  if (names.size() < 2) return names;
  const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
  std::size_t front = 0, back = 0, shortest = names[0].size();
  for (const auto& name : names) shortest = std::min(shortest, name.size());
  const auto common = [&](auto letter) {
    return std::all_of(names.begin(), names.end(),
                       [&](const auto& name) { return letter(name) == letter(names[0]); });
  };
  while (front < shortest && common([&](const auto& n) { return n[front]; }) &&
         !is_digit(names[0][front])) {
    ++front;
  }
  while (front + back < shortest && common([&](const auto& n) { return n[n.size() - 1 - back]; }) &&
         !is_digit(names[0][names[0].size() - 1 - back])) {
    ++back;
  }
  for (auto& name : names) {
    if (name.size() > front + back) name = name.substr(front, name.size() - front - back);
  }
  return names;
}

// A point a view: by frames found with it, and without it; those not used apart.
report::Figure PointsOf(const HandEyeResult& result, double HandEyeViewResult::*with,
                        double HandEyeViewResult::*without) {
  report::Figure figure;
  figure.x_label = "view";
  using enum report::FigureTrace::Kind;
  report::FigureTrace in{.name = "used", .kind = kPoints, .color = "#0072b2"};
  report::FigureTrace held{
      .name = "held out", .kind = kPoints, .color = "#009e73", .symbol = "circle-open"};
  report::FigureTrace out{.name = "not used", .kind = kPoints, .color = "#d55e00", .symbol = "x"};
  const std::vector<std::string> names = ShortNames(result);
  std::vector<double> used;
  for (std::size_t i = 0; i < result.views.size(); ++i) {
    const HandEyeViewResult& v = result.views[i];
    const bool shown = v.seen && std::isfinite(v.*with);
    for (auto* trace : {&in, &held, &out}) {
      const bool mine = shown && v.used == (trace != &out);
      trace->labels.push_back(names[i]);
      trace->y.push_back(mine ? v.*(trace == &held ? without : with) : std::nan(""));
    }
    if (shown) (v.used ? used : out.x).push_back(v.*with);
  }
  // One that is far off must not flatten the others.
  const double most = out.x.empty() ? 0.0 : *std::max_element(out.x.begin(), out.x.end());
  figure.log_y = !used.empty() && most > 5 * *std::max_element(used.begin(), used.end());
  out.x.clear();
  figure.traces = {in, held, out};
  std::erase_if(figure.traces, [](const report::FigureTrace& t) {
    return std::none_of(t.y.begin(), t.y.end(), [](double y) { return std::isfinite(y); });
  });
  return figure;
}

report::FigureTrace WristSteps(const HandEyeResult& result, bool orientation) {
  report::FigureTrace trace{.name = orientation ? "orientation (deg)" : "position (mm)",
                            .kind = report::FigureTrace::Kind::kPoints,
                            .color = orientation ? "#b0578d" : "#0072b2",
                            .symbol = orientation ? "diamond-open" : "circle"};
  trace.labels = ShortNames(result);
  for (const HandEyeViewResult& v : result.views) {
    const double step = orientation ? kDegrees * v.wrist_step.head<3>().norm()
                                    : 1e3 * v.wrist_step.tail<3>().norm();
    trace.y.push_back(v.used ? step : std::nan(""));
  }
  return trace;
}

std::vector<report::Figure> Figures(const HandEyeResult& result) {
  report::Figure px = PointsOf(result, &HandEyeViewResult::px, &HandEyeViewResult::held_out_px);
  px.name = "px";
  px.title = "Corners in the picture, view by view";
  px.caption =
      "RMS distance of the corners from where wrist and calibration put them, the wrist as "
      "measured. Held out: by a calibration without this view.";
  px.y_label = "distance (px)";
  report::Figure mm = PointsOf(result, &HandEyeViewResult::mm, &HandEyeViewResult::held_out_mm);
  mm.name = "mm";
  mm.title = "Corners in space, view by view";
  mm.caption =
      "RMS distance between the corners of the board as its picture alone has it and as wrist and "
      "calibration have it.";
  mm.y_label = "distance (mm)";
  report::Figure wrist{.name = "wrist",
                       .title = "What the fit corrects of the wrist",
                       .caption =
                           "From each measured wrist pose to the one that fits the picture best "
                           "within the wrist's noise.",
                       .x_label = "view",
                       .y_label = "correction (mm, deg)",
                       .traces = {WristSteps(result, false), WristSteps(result, true)}};
  return {px, mm, wrist};
}

std::string Quoted(std::string text) {
  std::replace(text.begin(), text.end(), ',', ';');  // a cell of a table without quotes
  return text;
}

}  // namespace

Json HandEyeSummary(const HandEyeResult& r, const Calibration& calibration) {
  return {{"views_used", r.views_used},
          {"views_rejected", r.views_rejected},
          {"rms_reprojection_error_px", NumberOrNull(r.rms_px)},
          {"rms_error_mm", NumberOrNull(r.rms_mm)},
          {"heldout_error_px", NumberOrNull(r.held_out_px)},
          {"heldout_error_mm", NumberOrNull(r.held_out_mm)},
          {"corner_noise_px", r.corner_noise_px},
          {"wrist_orientation_noise_scale", r.orientation_noise_scale},
          {"wrist_position_noise_scale", r.position_noise_scale},
          {"found", Deviations(calibration)},
          {"unobservable", UnobservableJson(calibration.unobservable)},
          {"helpful_motions", Motions(r)},
          {"views", Views(r)}};
}

void WriteHandEyeTables(const std::filesystem::path& folder, const HandEyeResult& result) {
  CsvWriter csv({"timestamp [ns]", "view", "corners []", "board [px]", "px [px]", "mm [mm]",
                 "heldout_px [px]", "heldout_mm [mm]", "chi2 []", "used []", "reason"});
  for (const HandEyeViewResult& v : result.views) {
    csv.Add(v.t_ns).Add(Quoted(v.name)).Add(static_cast<double>(v.corners)).Add(v.board_px);
    for (const double value : {v.px, v.mm, v.held_out_px, v.held_out_mm}) csv.AddOrEmpty(value);
    csv.Add(v.chi2).Add(v.used ? 1.0 : 0.0).Add(Quoted(v.reason));
    csv.EndRow();
  }
  WriteTextFile(folder / "residuals.csv", csv.text());
  report::WriteFigures(folder / "figures.json", Figures(result));
}

void DrawHandEyeView(Image& image, const HandEyeViewResult& view) {
  Drawing drawing(image);
  const int wide = std::max(1, image.width_px / 640);  // still seen where the picture is small
  constexpr Colour kSeen{60, 200, 60}, kChain{60, 60, 240};
  for (const Eigen::Vector2d& p : view.px_seen) drawing.Disc(p, 2 * wide, kSeen);
  for (const Eigen::Vector2d& p : view.px_chain) {
    if (p.cwiseAbs().maxCoeff() <= 1e5) drawing.Ring(p, 4 * wide, kChain, wide);
  }
  drawing.Label(std::isfinite(view.px)
                    ? fmt::format("{}: {:.2f} px, {:.2f} mm{}", view.name, view.px, view.mm,
                                  view.used ? "" : ", not used")
                    : fmt::format("{}: {}", view.name, view.reason));
}

std::string HandEyeInWords(const HandEyeResult& r, const Calibration& calibration) {
  std::string text = fmt::format(
      "{} views used, {} rejected; {:.2f} px, {:.2f} mm; held out {:.2f} px, {:.2f} mm\n",
      r.views_used, r.views_rejected, r.rms_px, r.rms_mm, r.held_out_px, r.held_out_mm);
  for (const auto& [name, pose] : calibration.poses) {
    const Eigen::MatrixXd C = calibration.CovarianceOf(name);
    text += fmt::format("{}: at ({:.2f}, {:.2f}, {:.2f}) mm, known to {:.2f} mm and {:.3f} deg\n",
                        name, 1e3 * pose.p.x(), 1e3 * pose.p.y(), 1e3 * pose.p.z(),
                        1e3 * std::sqrt(C.bottomRightCorner(3, 3).trace()),
                        kDegrees * std::sqrt(C.topLeftCorner(3, 3).trace()));
  }
  std::string last;
  for (const auto& u : calibration.unobservable) {
    if (u.reason != last) text += fmt::format("not known: {}: {}\n", u.parameter, u.reason);
    last = u.reason;
  }
  if (!r.motions.empty()) {
    const HandEyeMotion& m = r.motions.front();
    text += fmt::format("next: {} ({:.2f} mm would become {:.2f} mm)\n", m.words,
                        1e3 * m.sd_before_m, 1e3 * m.sd_after_m);
  }
  return text;
}

}  // namespace flextip
