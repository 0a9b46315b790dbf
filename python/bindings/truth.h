#pragma once

#include "recording/truth.h"

namespace flextip::python {

/// The truth beside a recording, as an object of Python's.
struct Truth {
  Series<TruthSample> samples;
};

}  // namespace flextip::python
