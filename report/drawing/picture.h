// Figures as picture files, without a browser.
#pragma once

#include <cstddef>
#include <filesystem>
#include <vector>

#include "report/figure.h"

namespace flextip::report {

/// Writes `figures` as one picture, row by row with so many `columns`, with the colours of a page.
/// The ending of `file` chooses PNG, SVG or PDF. Throws InputError on another ending, WorkError
/// where the file cannot be written.
void WritePicture(const std::filesystem::path& file, const std::vector<Figure>& figures,
                  std::size_t columns = 1);

}  // namespace flextip::report
