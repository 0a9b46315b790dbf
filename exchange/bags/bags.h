// The bags of one import, read as one.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "exchange/bags/bag.h"

namespace flextip::exchange {

class Bags {
 public:
  /// Throws InputError as OpenBag does.
  explicit Bags(const std::vector<std::filesystem::path>& files);

  /// Of all bags, each name once.
  const std::vector<BagTopic>& Topics() const { return topics_; }
  /// The topic of this name; null where there is none with messages.
  const BagTopic* Find(const std::string& name) const;

  /// Takes a message, counted from 1 in its topic.
  using Take = std::function<void(const BagMessage& message, long number)>;
  /// Reads all bags once, and gives every message to its topic's function. Throws InputError, which
  /// names the message, for one that cannot be read.
  void Read(const std::map<std::string, Take>& takes) const;

  std::vector<std::string> Remarks() const;

 private:
  std::vector<std::unique_ptr<Bag>> bags_;
  std::vector<BagTopic> topics_;
};

}  // namespace flextip::exchange
