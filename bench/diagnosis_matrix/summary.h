// The matrix in words and tables: figures, confusions and the list of misses.
#pragma once

#include <string>
#include <vector>

#include "bench/diagnosis_matrix/figures.h"

namespace flextip::bench {

std::string FigureTable(const std::vector<MatrixFigure>& figures);

/// Cases in rows (what was hidden) and columns (what was answered).
struct Confusion {
  std::string title;
  std::vector<std::string> rows, columns;
  std::vector<std::vector<int>> counts;  ///< [row][column]
  std::vector<int> right;                ///< the row's right column
};

/// One for each size, then for cases without a size (none, forms outside the catalogue).
std::vector<Confusion> Confusions(const std::vector<MatrixRecord>& records);
/// One for each sensor left out, then for effects left out of the catalogue.
std::vector<Confusion> LeaveOutConfusions(const std::vector<MatrixRecord>& records);

/// summary.json.
std::string SummaryJson(const std::vector<MatrixFigure>& figures,
                        const std::vector<Confusion>& confusions);

/// misses.txt: each case whose verdict is not its label, with what makes its recording again.
std::string Misses(const std::vector<MatrixRecord>& records);

/// Returns the matrix as SVG: panels one below the other, cells shaded by their share of the row
/// with the count in them. The right answer's cell is framed.
std::string ConfusionSvg(const std::vector<Confusion>& confusions, const std::string& title);

}  // namespace flextip::bench
