// What every chapter of the thesis gives when it is done again: numbers beside the thesis's, and
// figures.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "report/figure.h"

namespace flextip::reproduction {

/// One line of table.csv.
struct TableRow {
  std::string quantity;           ///< "2.3.1 part of the workspace with ||G|| > 1"
  std::optional<double> thesis;   ///< as published; empty: no number there
  std::optional<double> flextip;  ///< the result here; empty: no result
  std::string unit = {};          ///< "mm", "deg", ""
  std::string note = {};          ///< differences and causes, or agreement by construction
};

struct ChapterResult {
  std::vector<TableRow> rows;
  std::vector<report::Figure> figures;
};

struct ReproduceOptions {
  bool quick = false;  ///< coarse grids and few repetitions, for tests; numbers are not the same
  std::uint64_t seed = 1;  ///< seed of every random draw
};

/// Told how much of the chapter is done, 0 to 1; called by one thread at a time.
using ChapterProgress = std::function<void(double done)>;

/// One part of a chapter, and what share of the chapter's time it takes.
struct ChapterPart {
  ChapterResult (*run)(const ReproduceOptions&, const ChapterProgress&);
  double share;
};
/// The parts one after the other, their rows and figures together.
ChapterResult InParts(const std::vector<ChapterPart>& parts, const ReproduceOptions& options,
                      const ChapterProgress& progress);

/// The measures of motion errors: maps and trajectories of the two-link arm.
ChapterResult ReproduceChapter2(const ReproduceOptions& options, const ChapterProgress& progress);
/// The flexion model's Jacobian against the straight shaft's, and under noise.
ChapterResult ReproduceChapter3(const ReproduceOptions& options, const ChapterProgress& progress);
/// Moves in the plane, by steps and in silicone.
ChapterResult ReproduceChapter4(const ReproduceOptions& options, const ChapterProgress& progress);
/// Ten operators in three dimensions, and what other sensors give.
ChapterResult ReproduceChapter5(const ReproduceOptions& options, const ChapterProgress& progress);

}  // namespace flextip::reproduction
