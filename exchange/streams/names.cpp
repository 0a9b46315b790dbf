#include "exchange/streams/names.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <utility>

namespace flextip::exchange {
namespace {

bool IsSmall(char c) { return c >= 'a' && c <= 'z'; }
bool IsCapital(char c) { return c >= 'A' && c <= 'Z'; }
bool IsFigure(char c) { return c >= '0' && c <= '9'; }

bool Contains(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

// The first stream of which a word is among its hints.
std::string StreamOfWords(const std::vector<std::string>& words) {
  static const std::vector<std::pair<std::string, std::set<std::string>>> kHints{
      {"command0", {"command", "commanded", "cmd", "setpoint", "servo", "desired", "target"}},
      {"em1", {"em1", "port", "trocar"}},
      {"em0", {"em0", "em", "aurora", "ndi", "tracker", "emt", "rs", "trakstar"}},
      {"strain0", {"strain", "gage", "gages", "gauge", "gauges", "fbg"}},
      {"load0", {"load", "force", "forces", "ft", "wrench", "loadcell"}},
      {"wrist0",
       {"wrist", "robot", "tcp", "flange", "ee", "effector", "endeffector", "tool", "rw", "arm"}}};
  for (const auto& [stream, hints] : kHints) {
    for (const auto& word : words) {
      if (hints.contains(word)) return stream;
    }
  }
  return "";
}

}  // namespace

const std::vector<std::string>& TableStreams() {
  static const std::vector<std::string> streams{"wrist0", "command0", "em0",
                                                "em1",    "strain0",  "load0"};
  return streams;
}

const std::vector<std::string>& JointStreams() {
  static const std::vector<std::string> streams{"joints0", "joints_command0", "torque0"};
  return streams;
}

bool IsTableStream(const std::string& stream) { return Contains(TableStreams(), stream); }
bool IsJointStream(const std::string& stream) { return Contains(JointStreams(), stream); }
bool IsCamera(const std::string& stream) { return stream == "cam0" || stream == "cam1"; }

std::string TableStreamsText() { return "wrist0, command0, em0, em1, strain0 or load0"; }

std::vector<std::string> WordsOf(const std::string& name) {
  std::vector<std::string> words;
  std::string word;
  const auto end = [&] {
    if (!word.empty()) words.push_back(std::move(word));
    word.clear();
  };
  for (std::size_t i = 0; i < name.size(); ++i) {
    const char c = name[i];
    if (!IsSmall(c) && !IsCapital(c) && !IsFigure(c)) {
      end();
      continue;
    }
    if (i > 0 && IsCapital(c) && IsSmall(name[i - 1])) end();
    word += IsCapital(c) ? static_cast<char>(c - 'A' + 'a') : c;
  }
  end();
  return words;
}

std::string StreamNamed(const std::string& name) {
  auto words = WordsOf(name);
  if (std::string stream = StreamOfWords(words); !stream.empty()) return stream;
  for (auto& word : words) word.erase(word.find_last_not_of("0123456789") + 1);  // robot2
  return StreamOfWords(words);
}

}  // namespace flextip::exchange
