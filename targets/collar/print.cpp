#include "targets/collar/print.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/error.h"
#include "vision/tags/cells.h"

namespace flextip {
namespace {

using Eigen::Vector2d;

constexpr double kLeft_mm = 30.0, kTop_mm = 88.0, kBetween_mm = 14.0;
constexpr const char* kCut = "#808080";
constexpr int kMostStrips = 6;

double FlapOf(const CollarDesign& d) { return 0.6e3 * d.strip_face_m; }

double StripHeight(const CollarDesign& d) {
  return 1e3 * d.strip_face_m * d.wishes.faces + FlapOf(d);
}

void DrawStrip(const CollarDesign& d, const std::vector<Eigen::AlignedBox2d>& black,
               const Vector2d& at, Sheet& sheet) {
  const double width = 1e3 * d.length_m, face = 1e3 * d.strip_face_m;
  const double end = face * d.wishes.faces, height = end + FlapOf(d);
  const auto cut = [&](double x0, double y0, double x1, double y1) {
    sheet.Line(at + Vector2d(x0, y0), at + Vector2d(x1, y1), 0.08, kCut);
  };
  cut(0, 0, width, 0);
  cut(0, height, width, height);
  cut(0, 0, 0, height);
  cut(width, 0, width, height);
  for (int i = 0; i <= d.wishes.faces; ++i) {  // outside the strip: nothing disturbs a tag's white
    cut(-2.5, face * i, -0.6, face * i);
    cut(width + 0.6, face * i, width + 2.5, face * i);
  }
  sheet.Black(InMm(black, at));
  for (int i = 0; i < d.wishes.faces; ++i) {
    const int id = d.collar.tags[static_cast<std::size_t>(i)].id;
    sheet.Text(fmt::format("{}", id), at + Vector2d(-4.2, face * (i + 0.5) + 0.6), 1.9, false,
               true);
  }
  sheet.Text("glue", at + Vector2d(0.5 * width, end + 0.6 * FlapOf(d)), 1.9, false, true);
  sheet.Text("tip →", at + Vector2d(0.5 * width, -1.2), 2.4, false, true);
}

std::string IdsText(const TagCollar& collar) {
  std::string text;
  for (const CollarTag& tag : collar.tags) {
    text += fmt::format("{}{}", text.empty() ? "" : ", ", tag.id);
  }
  return text;
}

void DrawHead(const CollarDesign& d, Sheet& sheet) {
  sheet.Text(fmt::format("Tag collar: {} tags of {:.2f} mm on a shaft of {:g} mm", d.wishes.faces,
                         1e3 * d.tag_size_m, 1e3 * d.wishes.shaft_diameter_m),
             {kLeft_mm, 20.0}, 5.0, true);
  const std::string lines[] = {
      fmt::format("{}, ids {}; the tags' middles {:g} mm behind the tip", d.collar.family,
                  IdsText(d.collar), 1e3 * d.wishes.from_tip_m),
      "1. Print at 100 % (\"actual size\") on matt paper or label stock.",
      fmt::format("2. Check: both rulers must measure {}.0 mm, to 0.2 mm.", kRuler_mm),
      "3. Cut along the lines, fold at the marks, the tags outside.",
      fmt::format("4. Wrap around the mount ({:.2f} mm across its faces), \"tip\" toward the tip, "
                  "and glue.",
                  1e3 * d.across_m),
      "5. Measure a tag (black to black) and the middle's distance from the tip; correct",
      "    size_m and T_EG in tags0/sensor.yaml where they differ."};
  double y = 28.0;
  for (const std::string& line : lines) {
    sheet.Text(line, {kLeft_mm, y});
    y += 5.2;
  }
}

}  // namespace

std::vector<Eigen::AlignedBox2d> StripFace(const CollarDesign& d) {
  std::vector<Eigen::AlignedBox2d> black;
  for (std::size_t i = 0; i < d.collar.tags.size(); ++i) {
    const TagCells tag = ReadTagCells(d.collar.family, d.collar.tags[i].id);
    const Vector2d corner(0.5 * (d.length_m - d.plate_m),
                          (static_cast<double>(i) + 0.5) * d.strip_face_m - 0.5 * d.plate_m);
    for (int row = 0; row < tag.cells; ++row) {
      for (int column = 0; column < tag.cells; ++column) {
        if (tag.At(column, row) != TagCells::kBlack) continue;
        black.emplace_back(corner + d.cell_m * Vector2d(column, row),
                           corner + d.cell_m * Vector2d(column + 1, row + 1));
      }
    }
  }
  return black;
}

void PrintCollar(const CollarDesign& d, const Paper& paper, const std::filesystem::path& file) {
  const double width = 1e3 * d.length_m, height = StripHeight(d);
  const double room_x = paper.width_mm - kLeft_mm - kPrinterMargin_mm;
  const double room_y = paper.height_mm - kTop_mm - kPrinterMargin_mm;
  if (width > room_x || height > room_y) {
    throw InputError(fmt::format(
        "collar: the strip of {:.0f} x {:.0f} mm does not fit on {} with its text ({:.0f} x "
        "{:.0f} mm); take larger paper",
        width, height, paper.name, room_x, room_y));
  }
  Sheet sheet(file, paper);
  DrawHead(d, sheet);
  sheet.Ruler({kLeft_mm, 66.0}, kRuler_mm, false);
  sheet.Ruler({14.0, kTop_mm}, kRuler_mm, true);
  const auto black = StripFace(d);
  const int strips =
      std::clamp(static_cast<int>((room_x + kBetween_mm) / (width + kBetween_mm)), 1, kMostStrips);
  for (int i = 0; i < strips; ++i) {
    DrawStrip(d, black, {kLeft_mm + i * (width + kBetween_mm), kTop_mm}, sheet);
  }
  sheet.Finish();
}

}  // namespace flextip
