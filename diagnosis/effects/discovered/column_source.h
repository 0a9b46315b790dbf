// The columns of a discovered term's shape as C++ text, for an effect's source. Private to it.
#pragma once

#include <string>
#include <vector>

#include "diagnosis/effects/discovered/term.h"

namespace flextip::diagnosis {

/// Returns an expression a column, of the variable `v` and what BeforeColumns declares.
std::vector<std::string> ColumnSources(const Term& term);

/// Returns the statements that stand before the columns, of each input `i`.
std::string BeforeColumns(const Term& term);

}  // namespace flextip::diagnosis
