// Cases of a campaign, each in a process of its own, on this machine or over the ranks of mpirun.
#pragma once

#include <filesystem>
#include <functional>
#include <set>
#include <string>
#include <vector>

namespace flextip::bench {

/// A case that was done.
struct CaseResult {
  std::string record;  ///< a line for the file of records, without its line break
  std::string said;    ///< the same for the terminal
};

struct Campaign {
  std::filesystem::path records;        ///< a line a case, in the order of their ends
  int jobs = 1;                         ///< cases at a time, of each rank
  std::vector<std::string> names = {};  ///< of all cases, one of a kind
  std::set<std::string> done = {};      ///< those that have a record
  /// Works on the case of this index, with its share of the cores.
  std::function<CaseResult(std::size_t)> run = {};
};

/// Runs the cases that are not done, and prints a line for each. A case that crashed or threw has
/// no record: it is done again by the next call; WorkError says how many there were. Under mpirun,
/// all ranks make the same call. Returns whether this process has the file of records: not on the
/// ranks that worked for the first one. Call it before anything has begun a thread.
bool RunCampaign(const Campaign& campaign);

}  // namespace flextip::bench
