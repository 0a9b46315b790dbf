#include "batch/item.h"

#include <gtest/gtest.h>

#include <csignal>

#include "core/error.h"

namespace flextip::batch {
namespace {

TEST(BatchItem, ComesBackFromItsLine) {
  const Item item{"a b", {"-x", "", "tab\there", "line\nbreak", "\\t is no tab", "\\"}, 1.5e9};
  const std::string line = Pack(item);
  EXPECT_EQ(line.find('\n'), std::string::npos);
  const Item back = UnpackItem(line);
  EXPECT_EQ(back.name, item.name);
  EXPECT_EQ(back.arguments, item.arguments);
  EXPECT_EQ(back.size, item.size);
}

TEST(BatchItem, OutcomeComesBackFromItsLine) {
  const Outcome outcome{"a", Status::kCrashed, -1, SIGSEGV, 0.125, "host", "{\"x\":\t1}\n"};
  const Outcome back = UnpackOutcome(Pack(outcome));
  EXPECT_EQ(back.name, "a");
  EXPECT_EQ(back.status, Status::kCrashed);
  EXPECT_EQ(back.exit_code, -1);
  EXPECT_EQ(back.signal, SIGSEGV);
  EXPECT_EQ(back.seconds, 0.125);
  EXPECT_EQ(back.host, "host");
  EXPECT_EQ(back.payload, outcome.payload);
}

TEST(BatchItem, RefusesWhatIsNoOutcome) {
  EXPECT_THROW(UnpackOutcome("a\t0\t0"), InputError);
  EXPECT_THROW(UnpackOutcome("a\t9\t0\t0\t1\th\t"), InputError);
  EXPECT_THROW(UnpackOutcome("a\t0\tx\t0\t1\th\t"), InputError);
  EXPECT_THROW(UnpackItem("a"), InputError);
}

Outcome EndedBy(Status status, int signal) {
  Outcome outcome;
  outcome.status = status;
  outcome.signal = signal;
  return outcome;
}

TEST(BatchItem, HasItsStatusInWords) {
  EXPECT_EQ(StatusText(EndedBy(Status::kOk, 0)), "ok");
  EXPECT_EQ(StatusText(EndedBy(Status::kFailed, 0)), "failed");
  EXPECT_EQ(StatusText(EndedBy(Status::kTimedOut, SIGKILL)), "timed out");
  EXPECT_EQ(StatusText(EndedBy(Status::kCrashed, SIGSEGV)), "crashed SIGSEGV");
  EXPECT_EQ(StatusText(EndedBy(Status::kCrashed, SIGABRT)), "crashed SIGABRT");
}

}  // namespace
}  // namespace flextip::batch
