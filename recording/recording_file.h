// recording.yaml: the instrument, the port, gravity, tolerances.
#pragma once

#include <filesystem>

#include "recording/read_log.h"
#include "recording/recording.h"

namespace flextip {

/// The name and the version this program writes and reads.
inline constexpr const char* kRecordingFormat = "flextip-recording";
inline constexpr int kRecordingVersion = 1;

/// A recording without streams. Throws InputError with file and line for a missing file or key, an
/// unknown format or version, lengths and stiffnesses that are not positive, values not finite.
/// `instrument` and `port` may be absent, both, where an arm has no shaft (`may_lack_shaft`).
Recording ReadRecordingFile(const std::filesystem::path& file, ReadLog& log,
                            bool may_lack_shaft = false);

void WriteRecordingFile(const std::filesystem::path& file, const Recording& recording);

}  // namespace flextip
