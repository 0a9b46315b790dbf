// A picture file to draw on: PNG, SVG or PDF by the ending of its name (cairo).
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

struct _cairo;  // cairo's
struct _cairo_surface;

namespace flextip::report {

/// A place in the picture, in px from its top left corner; y points down. A px of a PDF is a point,
/// 1/72 inch.
struct Place {
  double x = 0.0, y = 0.0;
};

/// Where a text lies at its place: 0 begins there, 0.5 is centred, 1 ends there.
struct TextStyle {
  double size = 13.0;
  double align_x = 0.0, align_y = 1.0;  ///< 1 of y: the baseline
  bool bold = false;
  bool upward = false;  ///< turned by 90 degrees, read from below
  std::string color = "#1d2733";
};

class Canvas {
 public:
  /// Begins a white picture. Throws InputError where the name ends in neither .png, .svg nor .pdf,
  /// WorkError where cairo cannot make it.
  Canvas(std::filesystem::path file, double width_px, double height_px);

  /// Draws a line through `places`; `width` in px.
  void Line(const std::vector<Place>& places, const std::string& color, double width,
            bool dashed = false);
  /// Fills a polygon.
  void Fill(const std::vector<Place>& corners, const std::string& color, double opacity = 1.0);
  /// Fills rectangles given by opposite corners, as one shape: no seams where they touch.
  void FillTogether(const std::vector<std::pair<Place, Place>>& rectangles,
                    const std::string& color);
  /// Draws a disc, or a ring of width 1.5 px where not `filled`.
  void Disc(Place middle, double radius, const std::string& color, bool filled = true);
  void Text(const std::string& text, Place at, const TextStyle& style = {});
  /// Returns the width of `text` in px.
  double Width(const std::string& text, const TextStyle& style = {});
  /// Moves the origin of all places from now on.
  void Shift(double x_px, double y_px);
  /// Limits drawing to a rectangle until Unclip.
  void Clip(Place corner, double width, double height);
  void Unclip();

  /// Writes the file. Throws WorkError where the disk refuses.
  void Finish();

 private:
  void Color(const std::string& css, double opacity = 1.0);
  void Font(const TextStyle& style);
  void Path(const std::vector<Place>& places);

  std::filesystem::path file_;
  std::unique_ptr<_cairo_surface, void (*)(_cairo_surface*)> surface_;
  std::unique_ptr<_cairo, void (*)(_cairo*)> context_;
};

}  // namespace flextip::report
