// The parts of a drawn figure: what lies inside its axes.
#pragma once

#include <string>
#include <vector>

#include "report/drawing/axis.h"
#include "report/drawing/canvas.h"
#include "report/figure.h"

namespace flextip::report {

/// A rectangle of the picture with two axes.
struct PlotArea {
  double left = 0.0, top = 0.0, width = 0.0, height = 0.0;  ///< px
  Axis x{0.0, 1.0}, y{0.0, 1.0};
  bool y_down = false;

  Place At(double x_value, double y_value) const;
};

/// Returns the colour of trace `i`: its own, or the page's for its place in the list.
std::string TraceColor(const FigureTrace& trace, std::size_t i);
/// Returns the colour of a field's value, `share` from 0 to 1.
std::string FieldColor(double share);

/// Draws curves, points with their texts and error bars into the area.
void DrawTrace(const FigureTrace& trace, const std::string& color, const PlotArea& area,
               Canvas& canvas);
/// Draws bars `index` of `count` side by side; along x where `lying`. Categories are 0, 1, 2...
void DrawBars(const FigureTrace& trace, const std::string& color, std::size_t index,
              std::size_t count, bool lying, const PlotArea& area, Canvas& canvas);
/// Draws the colours, the contour lines and, for cells, the numbers of a field.
void DrawField(const FigureField& field, const PlotArea& area, Canvas& canvas);
/// Returns the least and largest value of a field's colours.
std::pair<double, double> FieldRange(const FigureField& field);

}  // namespace flextip::report
