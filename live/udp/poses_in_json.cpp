#include <cmath>
#include <nlohmann/json.hpp>

#include "live/udp/listener.h"

namespace flextip::live {
namespace {

using nlohmann::json;

constexpr std::size_t kMostPoses = 32;   // in a datagram
constexpr double kLatestTime_s = 9.0e9;  // the year 2255: more does not fit into nanoseconds

/// Adds the numbers of a list, and those of rows in it.
bool AddNumbers(const json& list, bool has_rows, std::vector<double>& numbers) {
  for (const json& item : list) {
    if (has_rows && item.is_array() && item.size() == 3) {
      if (!AddNumbers(item, false, numbers)) return false;
    } else if (item.is_number()) {
      numbers.push_back(item.get<double>());
    } else {
      return false;
    }
  }
  return true;
}

/// Seconds of today as one product would be off by a hundred nanoseconds.
TimeNs Nanoseconds(double t_s) {
  const double whole_s = std::floor(t_s);
  return static_cast<TimeNs>(whole_s) * 1'000'000'000 + std::llround(1e9 * (t_s - whole_s));
}

/// Returns a list of `count` finite numbers, perhaps in rows.
std::optional<std::vector<double>> NumbersOf(const json& object, const char* key,
                                             std::size_t count) {
  const auto found = object.find(key);
  if (found == object.end() || !found->is_array() || found->size() > count) return {};
  std::vector<double> numbers;
  if (!AddNumbers(*found, true, numbers) || numbers.size() != count) return {};
  for (const double number : numbers)
    if (!std::isfinite(number)) return {};
  return numbers;
}

std::optional<WireMessage> PoseOf(const std::string& name, const json& object) {
  const auto position = object.find("Position");
  if (position == object.end() || !position->is_object()) return {};
  const auto p = NumbersOf(*position, "Translation", 3);
  const auto R = NumbersOf(*position, "Rotation", 9);
  if (!p || !R) return {};
  WireMessage message;
  message.device = name;
  WireTransform transform;
  transform.T_RD.p = Eigen::Vector3d((*p)[0], (*p)[1], (*p)[2]);
  for (int i = 0; i < 9; ++i) transform.T_RD.R(i / 3, i % 3) = (*R)[static_cast<std::size_t>(i)];
  message.body = transform;
  const json& valid = object.contains("Valid") ? object["Valid"] : json(true);
  const json& stamp = object.contains("Timestamp") ? object["Timestamp"] : json(0.0);
  const bool is_valid = valid.is_boolean() ? valid.get<bool>() : valid == 1;
  const double t_s = stamp.is_number() ? stamp.get<double>() : 0.0;
  if (is_valid && t_s > 0.0 && t_s < kLatestTime_s) message.t_ns = Nanoseconds(t_s);
  return message;
}

}  // namespace

std::vector<WireMessage> PosesInJson(std::string_view datagram, std::string& problem) {
  std::vector<WireMessage> messages;
  problem.clear();
  // Deep nesting could exhaust the stack: a pose needs five levels.
  int depth = 0;
  for (const char c : datagram) {
    depth += c == '{' || c == '[' ? 1 : c == '}' || c == ']' ? -1 : 0;
    if (depth > 16) {
      problem = "nested too deeply";
      return messages;
    }
  }
  const json document = json::parse(datagram, nullptr, false);
  if (!document.is_object()) {
    problem = "no JSON object";
    return messages;
  }
  for (const auto& [name, object] : document.items()) {
    if (!object.is_object() || messages.size() == kMostPoses) continue;
    if (auto message = PoseOf(name, object)) messages.push_back(std::move(*message));
  }
  if (messages.empty()) problem = "no pose: expected Position with Translation and Rotation";
  return messages;
}

}  // namespace flextip::live
