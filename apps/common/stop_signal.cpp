#include "apps/common/stop_signal.h"

#include <csignal>

namespace flextip {
namespace {

volatile std::sig_atomic_t requested = 0;

void Note(int signal) {
  requested = 1;
  std::signal(signal, SIG_DFL);
}

}  // namespace

StopSignal::StopSignal() {
  requested = 0;
  std::signal(SIGINT, Note);
  std::signal(SIGTERM, Note);
}

StopSignal::~StopSignal() {
  std::signal(SIGINT, SIG_DFL);
  std::signal(SIGTERM, SIG_DFL);
}

bool StopSignal::Requested() { return requested != 0; }

}  // namespace flextip
