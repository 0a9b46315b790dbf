// Files that are inside the program, so that a report needs nothing beside it.
#pragma once

#include <string_view>

namespace flextip::report {

// The plotting library, of the version in package-lock.json: lines in the plane and in space, and
// all that is flat (contours, bars).
std::string_view PlotlyJs();
std::string_view PlotlyFlatJs();
std::string_view PageCss();    ///< report/embedded/page.css
std::string_view FiguresJs();  ///< report/embedded/figures.js
std::string_view TablesJs();   ///< report/embedded/tables.js

}  // namespace flextip::report
