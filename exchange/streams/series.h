// Rows as a stream of a recording.
#pragma once

#include <string>

#include "exchange/import_plan.h"
#include "exchange/streams/rows.h"
#include "recording/recording.h"

namespace flextip::exchange {

/// Adds the rows (SI units) of `stream` to the recording. Rotations are of the kind
/// `plan.orientation`; they are turned so that x points along the shaft, as `plan.axis` tells.
/// Throws InputError, with the place of the row, for what is no rotation.
void AddStream(const std::string& stream, const StreamRows& rows, StreamPlan& plan,
               Recording& recording, ImportLog& log);

}  // namespace flextip::exchange
