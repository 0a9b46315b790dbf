#include "exchange/bags/bags.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "core/error.h"

namespace flextip::exchange {

Bags::Bags(const std::vector<std::filesystem::path>& files) {
  for (const auto& file : files) {
    bags_.push_back(OpenBag(file));
    for (const BagTopic& topic : bags_.back()->Topics()) {
      const auto same = std::find_if(topics_.begin(), topics_.end(),
                                     [&](const BagTopic& t) { return t.name == topic.name; });
      if (same == topics_.end()) {
        topics_.push_back(topic);
      } else {
        same->messages += topic.messages;
      }
    }
  }
}

const BagTopic* Bags::Find(const std::string& name) const {
  const auto found = std::find_if(topics_.begin(), topics_.end(), [&](const BagTopic& topic) {
    return topic.name == name && topic.messages > 0;
  });
  return found == topics_.end() ? nullptr : &*found;
}

void Bags::Read(const std::map<std::string, Take>& takes) const {
  std::set<std::string> topics;
  for (const auto& [topic, take] : takes) topics.insert(topic);
  std::map<std::string, long> numbers;
  for (const auto& bag : bags_) {
    bag->Read(topics, [&](const BagMessage& message) {
      const std::string& topic = message.topic.name;
      const long number = ++numbers[topic];
      try {
        takes.at(topic)(message, number);
      } catch (const WireError& error) {
        throw InputError(fmt::format("{}: message {} {}", topic, number, error.what()));
      }
    });
  }
}

std::vector<std::string> Bags::Remarks() const {
  std::vector<std::string> remarks;
  for (const auto& bag : bags_) {
    remarks.insert(remarks.end(), bag->Remarks().begin(), bag->Remarks().end());
  }
  return remarks;
}

}  // namespace flextip::exchange
