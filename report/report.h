// A page that shows results and opens anywhere: plots, tables and pictures in one HTML file that
// loads nothing from a network.
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace flextip::report {

/// One curve: y over x, or a path in space where `z` is not empty. A value that is not finite
/// leaves a gap. All lists that are used have the same length.
struct PlotTrace {
  std::string name = {};
  std::vector<double> x = {}, y = {}, z = {};
  std::string color = {};  ///< as in CSS; empty: the page chooses
  bool dashed = false;
  bool markers = false;  ///< points instead of a line
};

/// A stretch of the x axis behind the curves.
struct PlotBand {
  double from = 0.0, to = 0.0;
  std::string color;
};

struct Plot {
  std::string title = {}, caption = {};
  std::string x_label = {}, y_label = {}, z_label = {};  ///< with the unit: "time (s)"
  std::vector<PlotTrace> traces = {};                    ///< all over x, or all in space
  bool log_y = false;
  std::vector<PlotBand> bands = {};
};

/// A row of texts for each line; cells are shown as they are.
struct Table {
  std::string title = {}, caption = {};
  std::vector<std::string> header = {};
  std::vector<std::vector<std::string>> rows = {};  ///< each as long as the header
};

/// Collects sections in the order they are added and writes them as one page.
class Report {
 public:
  /// `subtitle` stands below the title: the command as typed, the version.
  explicit Report(std::string title, std::string subtitle = "");

  /// Large figures at the head of the page: what it is, its value with unit.
  void AddFigures(const std::vector<std::pair<std::string, std::string>>& figures);
  /// A list of remarks in a box that cannot be overlooked; nothing where it is empty.
  void AddWarnings(const std::vector<std::string>& warnings);
  void AddHeading(const std::string& text);
  void AddText(const std::string& text);
  void AddTable(const Table& table);
  /// As it stands: for parts that a page draws itself. Its texts must be escaped already.
  void AddHtml(const std::string& html) { body_ += html; }
  void AddPlot(const Plot& plot);
  /// A figure of figures.json, given as its JSON text. A page has plots or figures, not both.
  void AddFigure(const std::string& title, const std::string& caption, const std::string& json);
  /// Pictures side by side, each a PNG or JPEG file's bytes with a caption.
  void AddPictures(const std::vector<std::pair<std::string, std::string>>& bytes_and_captions);

  /// The whole page.
  std::string Html() const;
  /// Writes the page beside `path` and moves it there. Throws WorkError where the disk refuses.
  void Write(const std::filesystem::path& path) const;

 private:
  std::string title_, subtitle_, body_;
  bool has_plots_ = false, has_figures_ = false;
};

/// `text` with the characters that HTML takes for its own replaced.
std::string EscapeHtml(const std::string& text);
/// RFC 4648 with padding.
std::string Base64(const std::string& bytes);

}  // namespace flextip::report
