// An effect by its name and reported parameters, as model.yaml holds them. Private to the extended
// model.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "diagnosis/model/effect.h"

namespace flextip::diagnosis {

/// Returns the effect of the catalogue or of `own` by its name, or the registration of the
/// sensors' frames; null for another name.
std::unique_ptr<Effect> MakeEffectOfModel(const std::string& name, const EffectMakers& own = {});

/// Returns the names and sizes of its parameters, with values of no effect and without deviations.
std::vector<ReportedParameter> ParametersOf(const Effect& effect);

}  // namespace flextip::diagnosis
