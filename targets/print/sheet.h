// A page to print to scale: places in mm, vector PDF, with rulers to check the printer by.
#pragma once

#include <Eigen/Geometry>
#include <filesystem>
#include <string>
#include <vector>

#include "report/drawing/canvas.h"

namespace flextip {

/// A sheet of paper as it lies before the reader.
struct Paper {
  std::string name;  ///< "a4"
  double width_mm = 210.0, height_mm = 297.0;
  Paper Turned() const { return {name, height_mm, width_mm}; }
};

/// Returns the paper of that name, upright: a4, a3, a2, a1, a0, letter or tabloid. Throws
/// InputError for others.
Paper PaperOf(const std::string& name);

/// Returns the least rectangles of a printed face: the same boxes in mm, moved to `corner_mm`.
std::vector<Eigen::AlignedBox2d> InMm(const std::vector<Eigen::AlignedBox2d>& boxes_m,
                                      const Eigen::Vector2d& corner_mm);

/// White on all sides that printers leave.
inline constexpr double kPrinterMargin_mm = 8.0;

class Sheet {
 public:
  /// Begins a page; `file` ends in .pdf, or .png or .svg for a preview. Throws as Canvas.
  Sheet(const std::filesystem::path& file, const Paper& paper);

  /// Fills boxes (mm) as one black shape.
  void Black(const std::vector<Eigen::AlignedBox2d>& boxes_mm);
  void Line(const Eigen::Vector2d& from_mm, const Eigen::Vector2d& to_mm, double width_mm = 0.1,
            const std::string& color = "#000000", bool dashed = false);
  /// Writes text whose baseline begins at `at_mm`, or is centred there; `size_mm` is the font's.
  void Text(const std::string& text, const Eigen::Vector2d& at_mm, double size_mm = 3.2,
            bool bold = false, bool centred = false);
  /// Draws a ruler of `length_mm` with a tick a mm, to the right of `from_mm` or below.
  void Ruler(const Eigen::Vector2d& from_mm, int length_mm, bool down);
  /// Writes the file. Throws WorkError where the disk refuses.
  void Finish() { canvas_.Finish(); }

 private:
  report::Canvas canvas_;
};

/// Length of the rulers that a print is checked by.
inline constexpr int kRuler_mm = 100;

}  // namespace flextip
