#include "batch/run.h"

#include <algorithm>
#include <numeric>

namespace flextip::batch {
namespace {

volatile std::sig_atomic_t caught = 0;

void Catch(int signal) { caught = signal; }

}  // namespace

std::vector<std::size_t> LargestFirst(const std::vector<Item>& items) {
  std::vector<std::size_t> order(items.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return items[a].size > items[b].size; });
  return order;
}

StopSignals::StopSignals() {
  caught = 0;
  struct sigaction action {};
  action.sa_handler = Catch;  // without SA_RESTART: whoever waits wakes up
  sigaction(SIGINT, &action, &interrupt_);
  sigaction(SIGTERM, &action, &terminate_);
}

StopSignals::~StopSignals() {
  sigaction(SIGINT, &interrupt_, nullptr);
  sigaction(SIGTERM, &terminate_, nullptr);
}

int StopSignals::Caught() { return caught; }

void RunItems(Pool& pool, const std::vector<Item>& items, const Done& done) {
  const std::vector<std::size_t> order = LargestFirst(items);
  std::size_t next = 0;
  while (next < order.size() || pool.running() > 0) {
    for (; next < order.size() && pool.HasRoom(); ++next)
      pool.Start(order[next], items[order[next]]);
    constexpr double kLook_s = 0.2;  // a signal just before the wait is seen after this time
    std::vector<Ended> ended = pool.Wait(kLook_s);
    // The next items begin before the disk is waited for.
    for (; next < order.size() && pool.HasRoom(); ++next)
      pool.Start(order[next], items[order[next]]);
    if (!ended.empty()) done(ended);
    if (StopSignals::Caught() != 0) return;
  }
}

}  // namespace flextip::batch
