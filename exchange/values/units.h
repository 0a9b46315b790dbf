// Units in the names of columns.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace flextip::exchange {

/// A value in SI is `value` * multiply / divide: exact for powers of ten.
struct Unit {
  std::string kind;  ///< time, length, angle, force, moment
  std::string name;  ///< as it is written in mapping files
  double multiply = 1.0, divide = 1.0;

  double ToSi(double value) const { return value * multiply / divide; }
};

/// The unit of `kind` that `text` names ("mm", "Nm", "degrees"); an empty `kind`: of any.
std::optional<Unit> ParseUnit(std::string_view text, const std::string& kind = "");

}  // namespace flextip::exchange
