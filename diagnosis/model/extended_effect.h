// An effect by its name and reported parameters, as model.yaml holds them. Private to the extended
// model.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "diagnosis/model/effect.h"

namespace flextip::diagnosis {

/// One of the catalogue, or the registration of sensors' frames; null for another name.
std::unique_ptr<Effect> MakeEffectOfModel(const std::string& name);

/// The names and sizes of its parameters, with values of no effect and without deviations.
std::vector<ReportedParameter> ParametersOf(const Effect& effect);

/// Whether a file may lack it, written before it was reported: it is then of no effect.
bool MayBeMissing(const std::string& effect, const std::string& parameter);

/// Why `values` mean nothing; empty where they do.
std::string WhatIsWrong(const Effect& effect, const std::vector<std::vector<double>>& values);

}  // namespace flextip::diagnosis
