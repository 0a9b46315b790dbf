// Options that are the same every day, in a file (docs/usage/defaults.md).
#pragma once

#include "apps/common/commands.h"

namespace flextip {

/// Adds --defaults FILE: TOML with a table a command, `track.camera = "camera.yaml"`. What is typed
/// goes before it. FLEXTIP_DEFAULTS names a file in place of the option. A key that is no option of
/// its command is refused. `context` must outlive the parsing.
void AddDefaults(CLI::App& app, AppContext& context);

}  // namespace flextip
