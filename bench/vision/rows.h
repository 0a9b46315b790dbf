// What the comparison keeps: the figures of all peers under one condition, as lines of JSON, as
// tables and as plots.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "bench/vision/figures.h"
#include "bench/vision/plot.h"

namespace flextip::bench {

/// All peers under one condition.
struct CompareRow {
  std::string sweep;  ///< the swept quantity, or the name of a set of pictures
  std::string unit;   ///< empty where nothing is swept
  double value = 0, gamma = 0;
  bool with_pose = true;  ///< false: tags are known alone
  std::vector<PeerFigures> peers;
};

/// JSON on one line. What could not be measured is null.
std::string RowText(const CompareRow& row);
/// Of a file with a row a line; a torn last line is left out, no file gives none. Throws InputError
/// with file and line for anything else.
std::vector<CompareRow> ReadRows(const std::filesystem::path& file);

/// A Markdown table: a line a peer, and one block a row; the swept value leads where there is one.
std::string CompareTable(const std::vector<CompareRow>& rows);
/// A line a peer, a column a value: the tip's RMS in mm, with the false poses where there are any.
std::string TipTable(const std::vector<CompareRow>& rows);
/// The same: tags found, in percent.
std::string RecallTable(const std::vector<CompareRow>& rows);

/// One figure (NaN: none) against each sweep's value, a panel a sweep.
std::vector<Panel> ComparePlots(const std::vector<CompareRow>& rows, const std::string& y_label,
                                double (*figure)(const PeerFigures&), bool log_y);

}  // namespace flextip::bench
