#include "apps/calibrate/camera/uncertainty_output.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "recording/text/csv.h"
#include "recording/text/text.h"

namespace flextip {
namespace {

// Colours end at so many times the mean: the corners of a picture without a board are far worse.
constexpr double kHighestOfMean = 3.0;

nlohmann::json MapJson(const UncertaintyMap& map) {
  nlohmann::json json = {
      {"centre_px", map.CentrePx()}, {"mean_px", map.MeanPx()}, {"largest_px", map.LargestPx()}};
  if (map.sd_mm.size() > 0) json["mean_mm"] = map.MeanMm();
  return json;
}

// The line around all corners used (Andrew's monotone chain).
report::FigureTrace HullOfCorners(const std::vector<SolvedView>& views) {
  std::vector<std::pair<double, double>> points;
  for (const SolvedView& view : views) {
    for (std::size_t i = 0; i < view.px.size(); ++i) {
      if (view.IsUsed(i)) points.emplace_back(view.px[i].x(), view.px[i].y());
    }
  }
  report::FigureTrace line{.name = "corners seen", .color = "#d55e00"};
  if (points.size() < 3) return line;
  std::sort(points.begin(), points.end());
  const auto add_half = [&](auto from, auto to) {
    std::vector<std::pair<double, double>> half;
    for (auto p = from; p != to; ++p) {
      const auto turns_left = [&] {
        const auto &a = half[half.size() - 2], &b = half.back();
        return (b.first - a.first) * (p->second - a.second) -
                   (b.second - a.second) * (p->first - a.first) >
               0;
      };
      while (half.size() >= 2 && !turns_left()) half.pop_back();
      half.push_back(*p);
    }
    for (const auto& [x, y] : half) {
      line.x.push_back(x);
      line.y.push_back(y);
    }
  };
  add_half(points.begin(), points.end());
  add_half(points.rbegin(), points.rend());
  return line;
}

report::Figure MapFigure(const UncertaintyMap& map, const std::string& camera,
                         const std::string& name, const std::string& where,
                         const std::vector<SolvedView>& views) {
  report::Figure figure;
  figure.name = fmt::format("{}-uncertainty-{}", camera, name);
  figure.title = fmt::format("{}: projection uncertainty {}", camera, where);
  figure.caption =
      "Standard deviation, in its worst direction, of where a point that stands still relative to "
      "the boards is seen after calibrating again from as noisy corners. The line is around all "
      "corners used.";
  figure.x_label = "x (px)";
  figure.y_label = "y (px)";
  figure.equal_axes = figure.y_down = true;
  report::FigureField field;
  field.name = "px";
  field.x = map.x_px;
  for (const double y : map.y_px) field.y.push_back(y);
  for (Eigen::Index row = 0; row < map.sd_px.rows(); ++row) {
    for (Eigen::Index column = 0; column < map.sd_px.cols(); ++column) {
      field.values.push_back(map.sd_px(row, column));
    }
  }
  field.low = 0.0;
  field.high = kHighestOfMean * map.MeanPx();
  figure.fields.push_back(field);
  figure.traces.push_back(HullOfCorners(views));
  return figure;
}

void AddRows(const UncertaintyMap& map, CsvWriter& csv) {
  for (Eigen::Index row = 0; row < map.sd_px.rows(); ++row) {
    for (Eigen::Index column = 0; column < map.sd_px.cols(); ++column) {
      csv.AddFixed(map.x_px[column], 1).AddFixed(map.y_px[row], 1).AddFixed(map.depth_m, 4);
      csv.AddFixed(map.sd_px(row, column), 5);
      csv.AddFixed(map.sd_mm.size() > 0 ? map.sd_mm(row, column) : HUGE_VAL, 6).EndRow();
    }
  }
}

std::string UncertaintyTable(const CameraUncertainty& u) {
  CsvWriter csv({"x [px]", "y [px]", "depth [m]", "sd [px]", "sd_across [mm]"});
  AddRows(u.near, csv);
  AddRows(u.far, csv);
  return csv.text();
}

}  // namespace

nlohmann::json UncertaintyJson(const CameraUncertainty& u) {
  nlohmann::json next = nlohmann::json::array();
  for (const NextView& view : u.next) {
    next.push_back(
        {{"do", view.words}, {"mean_px_before", view.before_px}, {"mean_px_after", view.after_px}});
  }
  return {{"working_distance_m", u.near.depth_m},
          {"at_working_distance", MapJson(u.near)},
          {"at_infinity", MapJson(u.far)},
          {"next_views", next}};
}

void WriteUncertainty(const std::filesystem::path& folder, const std::string& camera,
                      const CameraUncertainty& u, const std::vector<SolvedView>& views,
                      std::vector<report::Figure>& figures) {
  WriteTextFile(folder / (camera + "_uncertainty.csv"), UncertaintyTable(u));
  const std::string near = fmt::format("at {:.0f} mm", 1e3 * u.near.depth_m);
  figures.push_back(MapFigure(u.near, camera, "near", near, views));
  figures.push_back(MapFigure(u.far, camera, "far", "at infinity", views));
}

}  // namespace flextip
