// Items at work on this machine, each in a process of its own.
#pragma once

#include <sys/types.h>

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "batch/item.h"

namespace flextip::batch {

/// What is done with an item, in a process of its own. Returns the exit code (0: ok) and may leave
/// `payload` for the process that waits. An exception counts as exit code 1 with its message as the
/// payload.
using Work = std::function<int(const Item& item, std::string& payload)>;

struct PoolOptions {
  int jobs = 1;            ///< items at a time
  double timeout_s = 0.0;  ///< an item that takes longer is killed; 0: no limit
  /// Called in the waiting process for each item that ended, before anybody is told: to clear away
  /// what a crashed one left, or to look at what it wrote.
  std::function<void(Outcome&)> finish = {};
};

/// An item that ended.
struct Ended {
  std::size_t index = 0;  ///< as given to Start
  Outcome outcome;
};

/// Runs items in processes forked from a small one that is itself forked by the constructor. So an
/// item starts within a millisecond, with the program loaded and no thread running, and nothing
/// that it does (crash, exit, leak) reaches another item or the caller.
class Pool {
 public:
  /// Forks the process that starts items. To be made before the caller has threads, TBB or MPI.
  /// Throws WorkError where the system refuses.
  Pool(const Work& work, const PoolOptions& options);
  /// Kills what is at work.
  ~Pool();
  Pool(const Pool&) = delete;
  Pool& operator=(const Pool&) = delete;

  int jobs() const { return options_.jobs; }
  int running() const { return running_; }
  bool HasRoom() const { return running_ < options_.jobs; }

  /// Begins an item. `index` comes back with its end. Throws WorkError where the process that
  /// starts items was killed.
  void Start(std::size_t index, const Item& item);

  /// Returns the items that ended since the last call. Waits for the first of them up to
  /// `seconds` (below 0: without limit); returns none after that, and when a signal came. Throws
  /// WorkError where the process that starts items was killed.
  std::vector<Ended> Wait(double seconds);

  /// Readable when Wait has something to return or to throw.
  int descriptor() const { return socket_; }
  /// The process that starts items.
  pid_t process() const { return process_; }

 private:
  PoolOptions options_;
  int socket_ = -1;
  pid_t process_ = -1;
  int running_ = 0;
  std::string received_;
};

}  // namespace flextip::batch
