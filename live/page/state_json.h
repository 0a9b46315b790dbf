// What the page's watchers are told, as JSON. Lengths in m, angles in rad, in R; every
// number as it is, so that it reads back to the same bits. Private to live/page/.
#pragma once

#include <string>
#include <vector>

#include "live/page/findings.h"
#include "live/page/history.h"

namespace flextip::live {

/// What a new watcher is told first: the session, and what it has missed.
std::string HelloText(const Session& session, bool can_command, const PageHistory& history);

/// The run as it is, message number `n`. `end`: "" while it runs, "done", "earlier".
std::string StateText(long n, const Session& session, const PageSnapshot& snapshot,
                      const PageFindings& findings, const std::vector<PageEvent>& events,
                      const char* end);

/// What became of a person's wish. `why` it was refused: "token", "session"; "" where it was not.
std::string AnswerText(const std::string& wish, const char* why);

}  // namespace flextip::live
