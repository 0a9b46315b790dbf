// Whether known effects explain what an arm's recordings show.
#pragma once

#include "arms/replay/replay.h"
#include "arms/search/noise.h"
#include "arms/search/problem.h"

namespace flextip::arms {

/// Squared residuals in stated noise, of kept rows. Efforts of links without masses are left out:
/// friction has no simple law.
struct Misfit {
  double squares = 0.0, count = 0.0;
  double smooth_squares = 0.0;  ///< of these, what smooth functions of the joints take away
  int recordings = 0;

  double PerMeasurement() const;
};

/// Returns what the replay leaves. The smooth part is measured on stretches of time that its fit
/// did not see (five, each left out in turn), so that slow noise and drifts are no part of it.
Misfit MisfitOf(const Replay& replay, const Noise& noise, const Basis& basis,
                const Eigen::VectorXd& step);

/// Returns whether what the best known answer leaves is far beyond the noise and either much of
/// what the base leaves, or a function of the joints that no known effect has. The second is asked
/// of a single recording: several have changes between them, which look like that.
bool IsUnknown(const Misfit& base, const Misfit& best);

}  // namespace flextip::arms
