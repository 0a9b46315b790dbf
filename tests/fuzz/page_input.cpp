#include "tests/fuzz/page_input.h"

#include <algorithm>
#include <cstdlib>
#include <string>
#include <string_view>
#include <vector>

#include "live/page/server.h"
#include "live/page/watcher_texts.h"

namespace flextip {
namespace {

constexpr int kPort = 8080;

void Require(bool holds) {
  if (!holds) std::abort();
}

/// Only this machine's two names pass, as host and, where there is one, as origin.
void CheckTrust(std::string_view text) {
  const std::size_t end = std::min(text.find('\n'), text.size());
  const std::string_view host = text.substr(0, end);
  const std::string_view origin = end < text.size() ? text.substr(end + 1) : std::string_view();
  const bool expected =
      (host == "127.0.0.1:8080" && (origin.empty() || origin == "http://127.0.0.1:8080")) ||
      (host == "localhost:8080" && (origin.empty() || origin == "http://localhost:8080"));
  Require(live::IsFromHere(host, origin, kPort) == expected);
}

}  // namespace

int CheckPageInput(std::span<const std::uint8_t> input) {
  // A copy of exactly this size: a sanitizer sees what reads beyond it.
  const std::vector<char> bytes(input.begin(), input.end());
  const std::string_view text(bytes.data(), bytes.size());
  CheckTrust(text);
  const auto wish = live::ReadWish(text);
  if (wish) {
    Require(wish->what == "enable" || wish->what == "pause" || wish->what == "stop");
    Require(text.find(wish->what) != std::string_view::npos || text.find('\\') != text.npos);
    Require(wish->token.size() <= text.size());
  }
  const auto seen = live::ReadSeen(text);
  if (seen) {  // zeros may stand before the digits
    const std::string digits = std::to_string(*seen);
    const std::string_view read = text.substr(0, text.size() - 1);
    Require(text.substr(0, 8) == "{\"seen\":" && text.back() == '}');
    Require(read.ends_with(std::string_view(digits).substr(*seen < 0 ? 1 : 0)));
  }
  Require(!(wish && seen));
  return wish || seen ? 1 : 0;
}

}  // namespace flextip
