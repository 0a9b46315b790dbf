// Which settings each stream has, and the noise of a stream that nobody stated.
#pragma once

#include <Eigen/Dense>
#include <optional>
#include <string>
#include <vector>

#include "exchange/import_plan.h"

namespace flextip::exchange {

/// The streams that a table can hold: wrist0, command0, em0, em1, strain0, load0.
const std::vector<std::string>& TableStreams();
bool IsTableStream(const std::string& stream);
/// "wrist0, command0, em0, em1, strain0 or load0".
std::string TableStreamsText();

/// Takes `value` ("0.02", "0.12,0.5", "uniform") for `key` of a stream's sensor.yaml. Throws
/// InputError that begins with `where` for an unknown key or another kind of value.
void TellSensor(ImportPlan& plan, const std::string& where, const std::string& stream,
                const std::string& key, const std::string& value);

/// The standard deviation of one component, by the third differences of a series: white noise
/// stays, smooth motion goes. Empty for fewer than 20 values, and where it would be 0.
std::optional<double> MeasuredNoise(const std::vector<Eigen::VectorXd>& values);

}  // namespace flextip::exchange
