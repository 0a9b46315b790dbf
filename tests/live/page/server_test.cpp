// The page's server without a page.
#include "live/page/server.h"

#include <gmock/gmock.h>

#include <atomic>
#include <chrono>
#include <thread>

#include "core/error.h"
#include "live/page/web_files.h"
#include "tests/live/page/watcher_client.h"

namespace flextip::live {
namespace {

using testing::StartsWith;

TEST(Server, GoesOnAfterAFault) {
  std::atomic<int> faults{0};
  ServerHandlers handlers;
  handlers.hello = [] { return std::string("{}"); };
  handlers.answer = [](std::string_view) { return std::optional<std::string>(); };
  handlers.tick = [] { throw WorkError("a picture that cannot be drawn"); };
  handlers.fault = [&](const char*) { ++faults; };
  const PageServer server(0, WebFiles(), handlers, 200.0);
  while (faults < 3) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  EXPECT_THAT(Ask(server.port(), "/", HostOf(server.port())), StartsWith("HTTP/1.1 200"));
}

TEST(Secrets, AreEqualOnlyWhole) {
  EXPECT_TRUE(SameSecret("abc", "abc"));
  EXPECT_FALSE(SameSecret("abc", "abd"));
  EXPECT_FALSE(SameSecret("abc", "ab"));
  EXPECT_FALSE(SameSecret("", "a"));
}

}  // namespace
}  // namespace flextip::live
