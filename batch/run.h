// Hands items out: the largest first, each as soon as there is room.
#pragma once

#include <csignal>
#include <functional>
#include <vector>

#include "batch/item.h"
#include "batch/pool.h"

namespace flextip::batch {

/// Told of items that ended, in the calling process and in the order of their ends; `index` is that
/// in the list. May throw: nothing more is begun then.
using Done = std::function<void(const std::vector<Ended>& ended)>;

/// Returns the indices of `items` by size, the largest first; among equals in the list's order.
std::vector<std::size_t> LargestFirst(const std::vector<Item>& items);

/// While it lives, an interrupt or termination signal does not end the program but Run.
class StopSignals {
 public:
  StopSignals();
  ~StopSignals();
  StopSignals(const StopSignals&) = delete;
  StopSignals& operator=(const StopSignals&) = delete;

  /// The signal that came; 0: none.
  static int Caught();

 private:
  struct sigaction interrupt_ {
  }, terminate_{};
};

/// Runs all items in `pool`. Returns when all have ended, or when StopSignals has caught one: then
/// what is at work is lost. Throws what `done` throws, and WorkError where the process that starts
/// items was killed.
void RunItems(Pool& pool, const std::vector<Item>& items, const Done& done);

}  // namespace flextip::batch
