// Reads the commands' result files: tables of numbers, pictures.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "core/time_series.h"

namespace flextip::report {

/// A CSV file by columns. A cell that is empty or no number is NaN in `numbers`.
struct ResultTable {
  std::vector<std::string> names;
  std::vector<std::vector<double>> numbers;     ///< one list a column
  std::vector<std::vector<std::string>> texts;  ///< the same cells as written
  std::vector<TimeNs> t_ns = {};  ///< of the rows; empty where the first column is no timestamp

  std::size_t Rows() const { return numbers.empty() ? 0 : numbers.front().size(); }
  /// The column whose name is `name`, with or without its unit in brackets; nullptr where absent.
  const std::vector<double>* Column(const std::string& name) const;
  const std::vector<std::string>* Texts(const std::string& name) const;
};

/// A cell's number; NaN where it is empty or none.
double NumberIn(const std::string& cell);

/// Hands over the cells of a table over time row by row, with the columns' names and the row's
/// time. Throws as ReadResultTable, and where the first column is no timestamp.
void ForEachTimedRow(const std::filesystem::path& path,
                     const std::function<void(const std::vector<std::string>& names, TimeNs t_ns,
                                              const std::vector<std::string>& cells)>& row);

/// Throws InputError where the file is missing, a line has another number of cells, or a timestamp
/// is no whole number within its bounds.
ResultTable ReadResultTable(const std::filesystem::path& path);

/// A file's bytes. Throws InputError where it cannot be read.
std::string ReadBytes(const std::filesystem::path& path);

/// The pictures (PNG, JPEG) directly in `folder`, by name; at most `limit`, spread evenly over all.
std::vector<std::filesystem::path> PicturesIn(const std::filesystem::path& folder,
                                              std::size_t limit);

/// The sub-folders of `folder` that hold the file `name`, by name.
std::vector<std::filesystem::path> FoldersWith(const std::filesystem::path& folder,
                                               const std::string& name);

}  // namespace flextip::report
