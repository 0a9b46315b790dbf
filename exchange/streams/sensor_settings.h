// The settings that streams have in their sensor.yaml.
#pragma once

#include <string>
#include <vector>

#include "exchange/import_plan.h"

namespace flextip::exchange {

/// Takes `value` ("0.02", "0.12,0.5", "uniform") for `key` of a stream's sensor.yaml. Throws
/// InputError that begins with `where` for an unknown key or another kind of value.
void TellSensor(ImportPlan& plan, const std::string& where, const std::string& stream,
                const std::string& key, const std::string& value);

/// Throws NotTold for settings of the plan's streams that no file holds: where a sensor sits on the
/// shaft.
void NeedSettings(const ImportPlan& plan);

}  // namespace flextip::exchange
