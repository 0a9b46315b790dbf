// A tracker's set-up and pictures, for Tracker and Controller.
#pragma once

#include <optional>
#include <vector>

#include "pipeline/instrument_tracker.h"
#include "python/bindings/arrays.h"

namespace flextip::python {

/// Throws InputError where the recording has no cam0 or tags0.
InstrumentTrackerSetup TrackerSetupFor(const Recording& recording, const TrackerOptions& options,
                                       bool with_model);

/// Returns the pictures, empty images for None. Throws InputError as ImageFrom.
std::vector<Image> PicturesFrom(const std::vector<std::optional<py::array>>& pictures);
/// Returns a pointer to each, null for the empty ones.
std::vector<const Image*> PointersTo(const std::vector<Image>& images);

}  // namespace flextip::python
