// The result of a command in a sentence, for the head of its page.
#pragma once

#include <filesystem>
#include <string>

namespace flextip::report {

struct Lead {
  std::string says = {};  ///< the result; empty where the files do not tell
  std::string more = {};  ///< the next facts in importance
};

/// Returns the lead of a result folder by summary.json, for commands whose page has no verdict of
/// its own. Throws InputError where a file cannot be read.
Lead LeadOf(const std::filesystem::path& folder);

}  // namespace flextip::report
