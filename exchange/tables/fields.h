// What a field of a table is, by looking at its text.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace flextip::exchange {

/// Whether the line begins with # or %.
bool IsComment(std::string_view line);

/// The field as a number with a point and without a plus.
std::string WithPoint(std::string_view field, char decimal);

/// Whether digits stand on both sides of `sign` in a number.
bool HasDecimal(std::string_view field, char sign);

/// "1 2": two numbers in a field, so that its line was split in the wrong places.
bool HoldsSeveralNumbers(std::string_view field);

/// Whether no field is a value (a number or a clock text), and not all are empty.
bool NamesColumns(const std::vector<std::string_view>& fields);

/// NaN for a missing value (empty, NaN, NA, MISSING, a dash; a tracker's -3.7e28). Empty for what
/// is no number.
std::optional<double> NumberOrMissing(const std::string& text);

}  // namespace flextip::exchange
