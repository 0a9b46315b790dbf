#include "live/page/watcher_texts.h"

#include <charconv>
#include <nlohmann/json.hpp>

namespace flextip::live {

std::optional<PageWish> ReadWish(std::string_view text) {
  const auto json = nlohmann::json::parse(text, nullptr, false);
  if (!json.is_object() || !json.contains("do") || !json["do"].is_string()) return {};
  PageWish wish{json["do"], ""};
  if (wish.what != "enable" && wish.what != "pause" && wish.what != "stop") return {};
  if (json.contains("token") && json["token"].is_string()) wish.token = json["token"];
  return wish;
}

std::optional<long> ReadSeen(std::string_view text) {
  constexpr std::string_view begin = "{\"seen\":";
  if (text.substr(0, begin.size()) != begin || text.back() != '}') return {};
  text.remove_prefix(begin.size());
  text.remove_suffix(1);
  long n = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), n);
  if (error != std::errc() || end != text.data() + text.size()) return {};
  return n;
}

}  // namespace flextip::live
