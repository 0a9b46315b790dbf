// Results of commands, as reports, comparisons and exports read them again.
#include <cmath>

#include "exports/timed_table.h"
#include "report/compare/summary_values.h"
#include "report/diagnose/result.h"
#include "report/drawing/page_figures.h"
#include "report/result_files.h"
#include "report/thinned_table.h"
#include "tests/fuzz/files/input_folder.h"
#include "tests/fuzz/files/inputs.h"

namespace flextip {

int CheckTableInput(std::span<const std::uint8_t> input) {
  static const InputFolder folder;
  const auto file = folder.Write("stream/data.csv", TextOf(input));
  report::ResultTable table;
  if (!ReadsOrRefuses([&] { table = report::ReadResultTable(file); })) return 0;
  for (const auto& column : table.numbers) Require(column.size() == table.Rows());
  for (const auto& column : table.texts) Require(column.size() == table.Rows());
  const auto first = [](const std::vector<double>& values) { return values[0]; };
  ReadsOrRefuses([&] {
    const auto thinned = report::ReadThinned(file, {{{"p_RW_x"}, first}, {{"p_RE_x"}, first}},
                                             "status", {"ok", "lost"}, 4);
    Require(thinned.buckets.size() <= 4);
  });
  int paths = 0;
  ReadsOrRefuses([&] {
    for (const auto& timed : exports::ReadTimedTables(folder / "stream")) {
      for (const auto& path : exports::TrajectoriesIn(timed)) {
        for (const auto& pose : path.poses) {
          Require(pose.p.allFinite());
          Require(std::abs(pose.q.norm() - 1.0) < 1e-6);
        }
        ++paths;
      }
    }
  });
  return paths > 0 ? 1 : 0;
}

int CheckResultInput(std::span<const std::uint8_t> input) {
  static const InputFolder folder;
  const auto file = folder.Write("result/summary.json", TextOf(input));
  int understood = 0;
  understood += ReadsOrRefuses([&] { report::ReadRunSummary(file); }) ? 1 : 0;
  understood += ReadsOrRefuses([&] { report::ReadDiagnosedResult(file); }) ? 1 : 0;
  understood += ReadsOrRefuses([&] { report::ValuesOf(folder / "result"); }) ? 1 : 0;
  understood += ReadsOrRefuses([&] { report::ReadFigure(std::string(TextOf(input)), "page"); });
  return understood > 0 ? 1 : 0;
}

}  // namespace flextip
