#include "report/thinned_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <utility>

#include "core/error.h"
#include "report/result_files.h"

namespace flextip::report {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

std::ptrdiff_t Find(const std::vector<std::string>& names, const std::string& name) {
  const auto same = [&](const std::string& n) { return n == name || n.starts_with(name + " ["); };
  const auto it = std::find_if(names.begin(), names.end(), same);
  return it == names.end() ? -1 : it - names.begin();
}

/// Where the cells of a column's sources stand; empty where one is absent.
std::vector<std::size_t> Places(const std::vector<std::string>& names,
                                const ThinnedColumn& column) {
  std::vector<std::size_t> places;
  for (const auto& source : column.sources) {
    const auto place = Find(names, source);
    if (place < 0) return {};
    places.push_back(static_cast<std::size_t>(place));
  }
  return places;
}

class Thinner {
 public:
  Thinner(std::vector<std::string> by_worth, std::size_t max_buckets)
      : by_worth_(std::move(by_worth)),
        max_buckets_(std::max<std::size_t>(1, max_buckets / 2) * 2) {}

  void Add(ThinnedBucket row) {
    table_.end_s = row.t_s;
    if (!table_.buckets.empty() && rows_in_last_ < rows_a_bucket_) {
      Join(table_.buckets.back(), row);
      ++rows_in_last_;
      return;
    }
    if (table_.buckets.size() == max_buckets_) Halve();
    table_.buckets.push_back(std::move(row));
    rows_in_last_ = 1;
  }

  ThinnedTable Take() { return std::move(table_); }

 private:
  std::ptrdiff_t Worth(const std::string& text) const {
    return std::find(by_worth_.begin(), by_worth_.end(), text) - by_worth_.begin();
  }

  void Join(ThinnedBucket& a, const ThinnedBucket& b) const {
    if (Worth(b.worst_text) > Worth(a.worst_text)) a.worst_text = b.worst_text;
    for (std::size_t i = 0; i < a.columns.size(); ++i) {
      auto& to = a.columns[i];
      const auto& from = b.columns[i];
      if (std::isnan(from.least)) continue;
      if (!(to.least <= from.least)) {
        to.least = from.least;
        to.t_least_s = from.t_least_s;
      }
      if (!(to.greatest >= from.greatest)) {
        to.greatest = from.greatest;
        to.t_greatest_s = from.t_greatest_s;
      }
    }
  }

  // All buckets are full, and their number is even.
  void Halve() {
    auto& buckets = table_.buckets;
    for (std::size_t i = 0; i < buckets.size(); i += 2) {
      Join(buckets[i], buckets[i + 1]);
      if (i > 0) buckets[i / 2] = std::move(buckets[i]);
    }
    buckets.resize(buckets.size() / 2);
    rows_a_bucket_ *= 2;
  }

  std::vector<std::string> by_worth_;
  std::size_t max_buckets_, rows_a_bucket_ = 1, rows_in_last_ = 0;
  ThinnedTable table_;
};

}  // namespace

void ThinnedTable::Trace(std::size_t column, std::vector<double>& x, std::vector<double>& y) const {
  for (const ThinnedBucket& bucket : buckets) {
    const auto& range = bucket.columns[column];
    if (std::isnan(range.least)) {
      x.push_back(bucket.t_s);
      y.push_back(kNone);
      continue;
    }
    std::pair<double, double> a(range.t_least_s, range.least);
    std::pair<double, double> b(range.t_greatest_s, range.greatest);
    if (b.first < a.first) std::swap(a, b);
    x.push_back(a.first);
    y.push_back(a.second);
    if (a.first == b.first) continue;
    x.push_back(b.first);
    y.push_back(b.second);
  }
}

ThinnedTable ReadThinned(const std::filesystem::path& file,
                         const std::vector<ThinnedColumn>& columns, const std::string& text_column,
                         const std::vector<std::string>& by_worth, std::size_t max_buckets) {
  Thinner thinner(by_worth, max_buckets);
  std::vector<std::vector<std::size_t>> places;
  std::ptrdiff_t text_place = -1;
  TimeNs start_ns = 0;
  bool started = false;
  ForEachTimedRow(file, [&](const std::vector<std::string>& names, TimeNs t_ns,
                            const std::vector<std::string>& cells) {
    if (!started) {
      for (const auto& column : columns) places.push_back(Places(names, column));
      text_place = Find(names, text_column);
      start_ns = t_ns;
      started = true;
    }
    ThinnedBucket row;
    row.t_s = 1e-9 * static_cast<double>(t_ns - start_ns);
    if (text_place >= 0)
      row.first_text = row.worst_text = cells[static_cast<std::size_t>(text_place)];
    for (std::size_t i = 0; i < columns.size(); ++i) {
      std::vector<double> numbers;
      for (const std::size_t place : places[i]) numbers.push_back(NumberIn(cells[place]));
      const double v = numbers.empty() ? kNone : columns[i].value(numbers);
      row.columns.push_back({v, v, v, row.t_s, row.t_s});
    }
    thinner.Add(std::move(row));
  });
  return thinner.Take();
}

}  // namespace flextip::report
