// The derivatives of the rod with effects along a walked stretch, column by column: a variation
// carried from its start to its end. The equations are those of effect_flow.h.
#pragma once

#include <Eigen/Dense>
#include <span>

#include "kinematics/effect_flow.h"

namespace flextip::effect_flow {

inline constexpr int kMaxColumns = 16;  // full blocks of two and of four
using ColumnMatrix = Eigen::Matrix<double, 3, kMaxColumns, Eigen::RowMajor>;

/// The variations of the states at one place: a column for each parameter.
struct FlowColumns {
  ColumnMatrix turn = ColumnMatrix::Zero(), m = ColumnMatrix::Zero(), P = ColumnMatrix::Zero();
};

/// The change by each column along the stretch: of the force at its start, of q, and of the
/// curvature.
struct FlowForcing {
  ColumnMatrix dn0 = ColumnMatrix::Zero(), dq = ColumnMatrix::Zero();
  Eigen::Matrix<double, 2, kMaxColumns, Eigen::RowMajor> dcurvature =
      Eigen::Matrix<double, 2, kMaxColumns, Eigen::RowMajor>::Zero();
};

/// Carries the columns [first, last) along `path`: `columns` holds them at the start and then at
/// the end. `at[i]` takes them at `places[i]` from the start; a negative place is left out. Columns
/// up to the next multiple of four are carried too.
void CarryColumns(const FlowPath& path, const FlowForcing& forcing, int first, int last,
                  FlowColumns& columns, std::span<const double> places, FlowColumns* at);

/// The same two columns at a time, for any processor.
void CarryByTwo(const FlowPath& path, const FlowForcing& forcing, int first, int last,
                FlowColumns& columns, std::span<const double> places, FlowColumns* at);

}  // namespace flextip::effect_flow
