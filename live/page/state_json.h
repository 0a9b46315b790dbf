// What the page's watchers are told, as JSON. Lengths in m, angles in rad, in R; every number as it
// is, so that it reads back to the same bits. Private to live/page/.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "live/page/findings.h"
#include "live/page/snapshot.h"

namespace flextip::live {

/// Returns the session: told once to each watcher.
nlohmann::ordered_json SessionJson(const Session& session, bool can_command);

/// Returns the run as it is.
nlohmann::ordered_json StateJson(const Session& session, const PageSnapshot& snapshot,
                                 const PageFindings& findings);

/// Returns a change as an event.
nlohmann::ordered_json ChangeJson(const PageChange& change);

/// Returns [x, y, z].
nlohmann::ordered_json VectorJson(const Eigen::Vector3d& v);

/// Returns the text of `json`; letters of peers that are no UTF-8 are replaced.
std::string TextOf(const nlohmann::ordered_json& json);

}  // namespace flextip::live
