// Whether known effects explain what an arm's recordings show.
#pragma once

#include "arms/replay/replay.h"
#include "arms/search/noise.h"
#include "arms/search/problem.h"
#include "arms/search/search.h"

namespace flextip::arms {

/// Squared residuals in stated noise, of kept rows. Efforts of links without masses are left out:
/// friction has no simple law.
struct Misfit {
  double squares = 0.0, count = 0.0;

  double PerMeasurement() const;
};
Misfit MisfitOf(const Replay& replay, const Noise& noise);

/// Returns the squares, in stated noise, that smooth functions of the joints take away from what
/// `replay`, at the best answer, would leave if all effects of the catalogue were free (by the
/// derivatives there). Each of five stretches of time is predicted from the others, so that slow
/// noise and drifts are no part of it. 0 for several recordings: what changes between them looks
/// like that.
double SquaresOfAnotherForm(const Replay& replay, const Found& found, const Basis& basis,
                            const SearchOptions& options);

/// Returns whether what the best known answer leaves is far beyond the noise and either much of
/// what the base leaves, or of a form that no known effect has.
bool IsUnknown(const Misfit& base, const Misfit& best, double squares_of_another_form);

}  // namespace flextip::arms
