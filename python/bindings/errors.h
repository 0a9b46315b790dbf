// Errors and warnings as Python has them.
#pragma once

#include <string>
#include <vector>

namespace flextip::python {

/// Issues each text as a flextip.RecordingWarning of the Python code that called. Throws Python's
/// exception where the caller has made warnings errors.
void Warn(const std::vector<std::string>& texts);

}  // namespace flextip::python
