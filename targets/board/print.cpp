#include "targets/board/print.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/error.h"

namespace flextip {
namespace {

using Eigen::Vector2d;

// Above the board: two lines of text and a ruler; to its left: a ruler.
constexpr double kHead_mm = 30.0, kAside_mm = 12.0;

/// What the board needs of a sheet, without the printer's margins.
Vector2d Needed(const BoardFace& face) {
  const Vector2d margins = Vector2d::Constant(2e3 * face.margin_m);
  return 1e3 * face.extent.sizes() + margins + Vector2d(kAside_mm, kHead_mm);
}

Vector2d Room(const Paper& paper) {
  return Vector2d(paper.width_mm, paper.height_mm) - Vector2d::Constant(2.0 * kPrinterMargin_mm);
}

bool Fits(const BoardFace& face, const Paper& paper) {
  return (Needed(face).array() <= Room(paper).array() + 1e-6).all();
}

}  // namespace

BoardOnPaper PlaceBoard(const BoardFace& face, const Paper& upright) {
  const Paper paper = Fits(face, upright) ? upright : upright.Turned();
  if (!Fits(face, paper)) {
    const Vector2d needed = Needed(face), room = Room(upright), turned = Room(paper);
    const double part = std::max((room.array() / needed.array()).minCoeff(),
                                 (turned.array() / needed.array()).minCoeff());
    throw InputError(fmt::format(
        "board: {:.0f} x {:.0f} mm with its margin and rulers, and {} leaves {:.0f} x {:.0f} mm; "
        "make its squares {:.2f} times as large, or take larger paper",
        needed.x(), needed.y(), upright.name, room.x(), room.y(),
        std::floor(100.0 * part) / 100.0));
  }
  const Vector2d corner = Vector2d(kPrinterMargin_mm + kAside_mm, kPrinterMargin_mm + kHead_mm) +
                          0.5 * (Room(paper) - Needed(face)) +
                          Vector2d::Constant(1e3 * face.margin_m);
  return {paper, corner - 1e3 * face.extent.min()};
}

void PrintBoard(const BoardFace& face, const BoardOnPaper& place, const std::string& spec,
                const std::filesystem::path& file) {
  Sheet sheet(file, place.paper);
  const double left = kPrinterMargin_mm + kAside_mm;
  sheet.Text(spec, {left, 14.0}, 4.2, true);
  sheet.Text(fmt::format("Print at 100 % (\"actual size\"), glue on something stiff and flat. Both "
                         "rulers must measure {}.0 mm, to 0.2 mm.",
                         kRuler_mm),
             {left, 20.0}, 2.9);
  sheet.Ruler({left, 25.0}, kRuler_mm, false);
  sheet.Ruler({kPrinterMargin_mm, kPrinterMargin_mm + kHead_mm}, kRuler_mm, true);
  sheet.Black(InMm(face.black, place.origin_mm));
  sheet.Finish();
}

}  // namespace flextip
