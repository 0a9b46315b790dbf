// Recorded ROS messages, whatever file they are in.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "core/time_series.h"
#include "exchange/bags/wire.h"

namespace flextip::exchange {

struct BagTopic {
  std::string name;
  std::string type;  ///< "geometry_msgs/PoseStamped", of ROS 2 too
  WireFormat format = WireFormat::kRos1;
  long messages = 0;
};

struct BagMessage {
  const BagTopic& topic;
  TimeNs received_ns = 0;  ///< by the recorder
  Bytes data;
};

class Bag {
 public:
  virtual ~Bag() = default;

  virtual const std::vector<BagTopic>& Topics() const = 0;
  /// Calls `take` with every message of the topics, in the file's order. Throws InputError for a
  /// damaged file.
  virtual void Read(const std::set<std::string>& topics,
                    const std::function<void(const BagMessage&)>& take) const = 0;
  /// What had to be left out: a torn end, topics of another encoding.
  const std::vector<std::string>& Remarks() const { return remarks_; }

 protected:
  std::vector<std::string> remarks_;
};

/// Opens a bag of ROS 1 (.bag), an MCAP file, or the folder of a ROS 2 bag with MCAP files. Throws
/// InputError where the file is none of them or where this program was built without what reads it.
std::unique_ptr<Bag> OpenBag(const std::filesystem::path& path);

std::unique_ptr<Bag> OpenRosBag(const std::filesystem::path& file);
std::unique_ptr<Bag> OpenMcap(const std::vector<std::filesystem::path>& files);

}  // namespace flextip::exchange
