// Lines, rings and words drawn into a camera's picture, to a sixteenth of a pixel. Plots are no
// pictures: they are report::Figure.
#pragma once

#include <Eigen/Dense>
#include <string>

#include "core/image.h"

namespace flextip {

struct Colour {
  double blue = 0.0, green = 0.0, red = 0.0;  ///< 0 to 255
};

/// Draws into a picture of three channels, which must outlive it. Places are in pixels, (0, 0) the
/// middle of the first.
class Drawing {
 public:
  explicit Drawing(Image& image) : image_(image) {}

  void Line(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Colour& colour,
            int thickness_px = 1);
  void Cross(const Eigen::Vector2d& middle, double arm_px, const Colour& colour);
  void Ring(const Eigen::Vector2d& middle, int radius_px, const Colour& colour,
            int thickness_px = 1);
  void Disc(const Eigen::Vector2d& middle, int radius_px, const Colour& colour);
  void Ellipse(const Eigen::Vector2d& middle, const Eigen::Vector2d& half_axes_px, double angle_deg,
               const Colour& colour);
  /// Writes with a dark rim, `begin` at the lower left of the first letter.
  void Text(const std::string& text, const Eigen::Vector2i& begin, double scale,
            const Colour& colour);
  /// Writes in white at the picture's upper left.
  void Label(const std::string& text);

 private:
  Image& image_;
};

}  // namespace flextip
