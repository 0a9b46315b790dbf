// What the catalogue's answer does not explain: terms beside it, or terms in its place.
#pragma once

#include <memory>

#include "diagnosis/discovery/refit.h"

namespace flextip::diagnosis {

/// The terms that no effect explains: beside the effects of `known`, the catalogue's best, or,
/// where that leaves less to explain, beside none. `base` stands at the base simulation, `best`
/// where `known` fits. Null where there is no such term.
std::unique_ptr<TermModel> FindTerms(const Replay& base, Replay& best, const Selection& selection,
                                     const WeighedHypothesis& known,
                                     const DiagnoseOptions& options);

}  // namespace flextip::diagnosis
