// A page that shows results and opens anywhere: plots, tables and pictures in one HTML file that
// loads nothing from a network.
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "report/figure.h"

namespace flextip::report {

/// A row of texts for each line; cells are shown as they are.
struct Table {
  std::string title = {}, caption = {};
  std::vector<std::string> header = {};
  std::vector<std::vector<std::string>> rows = {};  ///< each as long as the header
};

/// Collects sections in the order they are added and writes them as a page.
class Report {
 public:
  /// Takes a `subtitle` for below the title: the command as typed, the version.
  explicit Report(std::string title, std::string subtitle = "");

  /// Adds doubts of the input, each with the line that mends it, in a box that cannot be
  /// overlooked; adds nothing for an empty list.
  void AddBeware(const std::vector<std::pair<std::string, std::string>>& doubts_and_mends);
  /// Adds large numbers: the name of each, its value with unit.
  void AddNumbers(const std::vector<std::pair<std::string, std::string>>& figures);
  /// Adds a list of remarks in a box that cannot be overlooked; adds nothing for an empty list.
  void AddWarnings(const std::vector<std::string>& warnings);
  void AddHeading(const std::string& text);
  void AddTable(const Table& table);
  /// Puts HTML below all that is added: how the results were made.
  void SetEnd(const std::string& html) { end_ = html; }
  /// Adds HTML unchanged: for parts that a page draws itself. Its texts must be escaped already.
  void AddHtml(const std::string& html) { body_ += html; }
  /// Adds figures, side by side where there are several and the page is wide. Those of a page are
  /// all in space or all flat with fields or bars: lines alone go with both.
  void AddFigures(const std::vector<Figure>& figures);
  void AddFigure(const Figure& figure) { AddFigures({figure}); }
  /// Adds a figures.json, under `heading` where there is a figure. Throws InputError where the file
  /// is no list of figures.
  void AddFigureFile(const std::filesystem::path& file, const std::string& heading = "");
  /// Adds pictures side by side, each a PNG or JPEG file's bytes with a caption.
  void AddPictures(const std::vector<std::pair<std::string, std::string>>& bytes_and_captions);

  /// Returns the whole page.
  std::string Html() const;
  /// Writes the page beside `path` and moves it there. Throws WorkError where the disk refuses.
  void Write(const std::filesystem::path& path) const;

 private:
  /// Adds a drawing from the `json` of a figure.
  void AddDrawing(const std::string& title, const std::string& caption, const std::string& json,
                  bool in_space, bool lone = false);

  std::string title_, subtitle_, body_, end_;
  bool has_figures_ = false, has_space_ = false, has_flat_ = false;  ///< flat: fields or bars
};

/// Returns `text` with HTML's own characters replaced.
std::string EscapeHtml(const std::string& text);
/// Returns the bytes in RFC 4648 with padding.
std::string Base64(const std::string& bytes);

}  // namespace flextip::report
