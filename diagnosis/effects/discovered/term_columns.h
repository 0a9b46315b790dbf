// What a term's variables are at an instant, and its columns there.
#pragma once

#include <Eigen/Dense>
#include <array>

#include "diagnosis/effects/discovered/term.h"
#include "diagnosis/model/effect.h"

namespace flextip::diagnosis {

/// A term's variables at one instant. Of vectors the components; of own_value those of the target.
struct TermState {
  double t_s = 0.0;
  std::array<double, 7> scalar{};  ///< in the order of TermVariable, time to distance_to_camera
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< of the tip, or of the EM sensor, in R
  Eigen::Vector3d orientation = Eigen::Vector3d::UnitX();
  Eigen::Vector2d image = Eigen::Vector2d::Zero();  ///< over the depth: tangents
  Eigen::Vector4d own = Eigen::Vector4d::Zero();    ///< the target's own true values
};

/// Returns them at `now`, for a term of `target`. Speeds are central differences where `now` has
/// neighbours, else smoothed differences to the last instant, by `memory` (its last five numbers).
/// Without a shape in `now` what follows from it is zero.
TermState StateAt(TermTarget target, const Instant& now, EffectMemory& memory);

/// A row an input, a column a column of the shape.
using TermColumns =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMostTermInputs, kMostTermColumns>;

/// Returns the columns of `term`'s shape (its amplitudes do not matter). Shapes that remember do so
/// by `memory` (its first three to five numbers), instant by instant in order of time. Inputs that
/// share a variable have equal rows; `one_row`: then one row alone.
TermColumns ColumnsAt(const Term& term, const TermState& state, EffectMemory& memory,
                      bool one_row = false);

}  // namespace flextip::diagnosis
