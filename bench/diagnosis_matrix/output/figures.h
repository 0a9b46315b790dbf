// The matrix in figures: how often the diagnosis is right, how sure it is, how good its numbers.
#pragma once

#include <string>
#include <vector>

#include "bench/diagnosis_matrix/record.h"

namespace flextip::bench {

/// One figure over a group of cases.
struct MatrixFigure {
  std::string figure, group;
  double value = 0.0;
  int of = 0;  ///< number of cases (or values) behind the figure
  std::string target;
};

/// In the order of printing; figures without cases are left out.
std::vector<MatrixFigure> Figures(const std::vector<MatrixRecord>& records);

}  // namespace flextip::bench
