// Files that are inside the program, so that a report needs nothing beside it.
#pragma once

#include <string_view>

namespace flextip {

std::string_view PlotlyJs();  ///< the plotting library, of the version in package-lock.json
std::string_view PageCss();   ///< report/page.css
std::string_view PageJs();    ///< report/page.js

}  // namespace flextip
