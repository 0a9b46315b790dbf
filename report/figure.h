// Figures as data, the only way to draw on a page: a page adds them, or a command writes
// figures.json beside its tables and its page draws that file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

namespace flextip::report {

/// One curve, set of points or set of bars; a path in space where `z` is not empty. A value that is
/// not finite leaves a gap. Lists that are used have the same length.
struct FigureTrace {
  enum class Kind : std::uint8_t { kLine, kPoints, kBars };

  std::string name = {};  ///< text in the legend; empty: no entry
  Kind kind = Kind::kLine;
  std::vector<double> x = {}, y = {}, z = {};
  std::vector<std::string> labels = {};  ///< in place of `x`: categories
  std::vector<double> y_error = {};      ///< half lengths of error bars; empty: none
  std::vector<std::string> texts = {};   ///< written beside each point or bar; empty: none
  std::string color = {};                ///< as in CSS; empty: the page chooses
  std::vector<std::string> colors = {};  ///< the bars' colours, in place of `color`
  std::string symbol = {};               ///< the points' symbol, named by Plotly ("circle-open")
  double width = 0.0;                    ///< of a line, in px; 0: the page's
  bool dashed = false;
  bool arrow = false;  ///< the line's last point has a head
};

/// A quantity over a grid, as colours with contour lines, or as cells with numbers.
struct FigureField {
  std::string name = {};               ///< label of the colours' scale, with the unit
  std::vector<double> x = {}, y = {};  ///< the grid's lines
  std::vector<double> values = {};     ///< y.size() rows of x.size(); NaN: nothing there
  std::vector<double> levels = {};     ///< values of the contour lines
  double low = std::numeric_limits<double>::quiet_NaN();  ///< the first colour; NaN: least value
  double high = std::numeric_limits<double>::quiet_NaN();
  bool cells = false;  ///< x, y are middles of cells; each cell has a colour and its value as text
};

/// A stretch of the x axis behind the curves; a dashed line where it has no length.
struct FigureBand {
  double from = 0.0, to = 0.0;
  std::string color;
};

struct Figure {
  std::string name = {};  ///< "fig-2-4a": in files and links
  std::string title = {}, caption = {};
  std::string x_label = {}, y_label = {}, z_label = {};  ///< with the unit: "depth (mm)"
  bool log_x = false, log_y = false;
  bool y_down = false;                   ///< as in a picture
  bool equal_axes = false;               ///< a length is as long in both directions
  bool lying_bars = false;               ///< bars run along x, below each other; labels on the left
  std::vector<FigureField> fields = {};  ///< none or one
  std::vector<FigureTrace> traces = {};  ///< on top of the field; all in space, or none
  std::vector<FigureBand> bands = {};
  std::vector<std::string> y_names = {};  ///< of the rows 0, 1, 2 ... in place of y's numbers

  bool InSpace() const { return !traces.empty() && !traces.front().z.empty(); }
};

/// Returns short line segments as a single trace with gaps, each through its middle (x, y) along
/// (u, v) with the length of (u, v): a plot of directions whose sign means nothing.
FigureTrace Segments(const std::vector<double>& x, const std::vector<double>& y,
                     const std::vector<double>& u, const std::vector<double>& v);

/// Returns the figure as JSON, as figures.json lists it (docs/formats.md).
std::string FigureText(const Figure& figure);

/// Writes figures.json. Throws WorkError where the disk refuses.
void WriteFigures(const std::filesystem::path& file, const std::vector<Figure>& figures);

}  // namespace flextip::report
