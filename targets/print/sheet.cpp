#include "targets/print/sheet.h"

#include <fmt/format.h>

#include "core/error.h"

namespace flextip {
namespace {

constexpr double kPointsPerMm = 72.0 / 25.4;

report::Place At(const Eigen::Vector2d& mm) {
  return {kPointsPerMm * mm.x(), kPointsPerMm * mm.y()};
}

}  // namespace

Paper PaperOf(const std::string& name) {
  for (const Paper& paper :
       {Paper{"a4", 210.0, 297.0}, Paper{"a3", 297.0, 420.0}, Paper{"a2", 420.0, 594.0},
        Paper{"a1", 594.0, 841.0}, Paper{"a0", 841.0, 1189.0}, Paper{"letter", 215.9, 279.4},
        Paper{"tabloid", 279.4, 431.8}}) {
    if (name == paper.name) return paper;
  }
  throw InputError(fmt::format("paper '{}': expected a4, a3, a2, a1, a0, letter or tabloid", name));
}

std::vector<Eigen::AlignedBox2d> InMm(const std::vector<Eigen::AlignedBox2d>& boxes_m,
                                      const Eigen::Vector2d& corner_mm) {
  std::vector<Eigen::AlignedBox2d> boxes_mm;
  boxes_mm.reserve(boxes_m.size());
  for (const auto& box : boxes_m) {
    boxes_mm.emplace_back(corner_mm + 1e3 * box.min(), corner_mm + 1e3 * box.max());
  }
  return boxes_mm;
}

Sheet::Sheet(const std::filesystem::path& file, const Paper& paper)
    : canvas_(file, kPointsPerMm * paper.width_mm, kPointsPerMm * paper.height_mm) {}

void Sheet::Black(const std::vector<Eigen::AlignedBox2d>& boxes_mm) {
  std::vector<std::pair<report::Place, report::Place>> rectangles;
  rectangles.reserve(boxes_mm.size());
  for (const auto& box : boxes_mm) rectangles.emplace_back(At(box.min()), At(box.max()));
  canvas_.FillTogether(rectangles, "#000000");
}

void Sheet::Line(const Eigen::Vector2d& from_mm, const Eigen::Vector2d& to_mm, double width_mm,
                 const std::string& color, bool dashed) {
  canvas_.Line({At(from_mm), At(to_mm)}, color, kPointsPerMm * width_mm, dashed);
}

void Sheet::Text(const std::string& text, const Eigen::Vector2d& at_mm, double size_mm, bool bold,
                 bool centred) {
  canvas_.Text(text, At(at_mm),
               {.size = kPointsPerMm * size_mm,
                .align_x = centred ? 0.5 : 0.0,
                .bold = bold,
                .color = "#000000"});
}

void Sheet::Ruler(const Eigen::Vector2d& from_mm, int length_mm, bool down) {
  const Eigen::Vector2d along = down ? Eigen::Vector2d::UnitY() : Eigen::Vector2d::UnitX();
  const Eigen::Vector2d aside = down ? Eigen::Vector2d::UnitX() : Eigen::Vector2d::UnitY();
  Line(from_mm, from_mm + length_mm * along);
  for (int mm = 0; mm <= length_mm; ++mm) {
    const double tick_mm = mm % 10 == 0 ? 4.0 : mm % 5 == 0 ? 2.8 : 1.6;
    const Eigen::Vector2d at = from_mm + mm * along;
    Line(at, at + tick_mm * aside);
    if (mm % 10 != 0) continue;
    const Eigen::Vector2d label = at + 7.5 * aside + (down ? 0.9 : 0.0) * along;
    Text(fmt::format("{}", mm), label, 2.6, false, true);
  }
  if (!down) Text("mm", from_mm + (length_mm + 4.0) * along + 7.5 * aside, 2.6);
}

}  // namespace flextip
