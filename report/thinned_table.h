// A long CSV file, thinned as it is read: memory does not grow with its length.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace flextip::report {

/// A number of each row, made from the cells of some columns.
struct ThinnedColumn {
  std::vector<std::string> sources;  ///< names, with or without their units
  std::function<double(const std::vector<double>&)> value;
};

/// What neighbouring rows have in common. Of each column the least and the greatest number with
/// their times, and the first row's; NaN where there is none.
struct ThinnedBucket {
  struct Range {
    double first, least, greatest, t_least_s, t_greatest_s;
  };
  double t_s = 0.0;  ///< time of the first row
  std::string first_text, worst_text;
  std::vector<Range> columns;
};

struct ThinnedTable {
  std::vector<ThinnedBucket> buckets;
  double end_s = 0.0;  ///< the last row's time

  /// The column over time, both ends of each bucket's range; a bucket of one row is one point.
  void Trace(std::size_t column, std::vector<double>& x, std::vector<double>& y) const;
};

/// Reads FILE, whose first column is a time in ns (t_s counts from the first row's), into at most
/// `max_buckets`. `text_column` has words; of a bucket's the one that is last in `by_worth` is
/// kept. A column whose source is absent is NaN throughout. Throws InputError as ReadResultTable
/// does.
ThinnedTable ReadThinned(const std::filesystem::path& file,
                         const std::vector<ThinnedColumn>& columns, const std::string& text_column,
                         const std::vector<std::string>& by_worth, std::size_t max_buckets);

}  // namespace flextip::report
