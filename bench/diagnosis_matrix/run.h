// Makes a hidden recording, has the folder diagnosed, and compares with the label kept apart.
#pragma once

#include "bench/diagnosis_matrix/record.h"

namespace flextip::bench {

/// The recording is written to a new folder under the system's temporary one, without its label,
/// and removed again. A recording the diagnosis refuses gives a record with `error`.
MatrixRecord RunMatrixCase(const MatrixCase& one);

}  // namespace flextip::bench
