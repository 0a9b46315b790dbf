// The figures of a result folder as data, read back from its page.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "report/figure.h"

namespace flextip::report {

/// Returns all figures of FOLDER/report.html in their order, each with a name of its own: the
/// figure's, or one made of its title. Throws InputError where there is no page, or where a figure
/// on it cannot be read.
std::vector<Figure> FiguresOfPage(const std::filesystem::path& folder);

/// Returns a figure from its JSON text (docs/formats.md), the inverse of FigureText. Throws
/// InputError naming `where` for text that is no figure.
Figure ReadFigure(const std::string& text, const std::string& where);

}  // namespace flextip::report
