// Figures as picture files, without a browser.
#pragma once

#include <filesystem>
#include <vector>

#include "report/figure.h"

namespace flextip::report {

/// Writes `figures` below each other as one picture, with the colours of a page. The ending of
/// `file` chooses PNG, SVG or PDF. Throws InputError on another ending, WorkError where the file
/// cannot be written.
void WritePicture(const std::filesystem::path& file, const std::vector<Figure>& figures);

}  // namespace flextip::report
