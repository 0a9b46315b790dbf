// How often a broken recording is named rightly, way by way, and what is found in healthy ones.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace flextip::bench {

struct WayRow {
  std::string way, finding;
  int recordings = 0, named = 0;
  int others = 0;                    ///< wrong findings beside the right one
  std::vector<std::string> remarks;  ///< of each that was not named, or had others
};

struct HealthyRow {
  std::string name;
  std::vector<std::string> findings;  ///< none: as it should be
};

struct CheckTable {
  std::vector<WayRow> ways;
  std::vector<HealthyRow> healthy;

  int Recordings() const;
  int Named() const;
  int Others() const;
  int HealthyWithFindings() const;
  /// Returns the table as Markdown.
  std::string Markdown() const;
};

struct CheckTableOptions {
  std::uint64_t seed = 1;
  int healthy = 100, per_way = 3;
  int bases = 24;         ///< recordings that are broken, each in many ways
  std::string ways = {};  ///< of those with this in their name or finding alone; empty: all
};

/// `progress` is told the recordings done, and all.
CheckTable MeasureChecks(const CheckTableOptions& options,
                         const std::function<void(int done, int all)>& progress);

}  // namespace flextip::bench
