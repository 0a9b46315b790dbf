// Bags of ROS 1, by Debian's librosbag-storage where this program was built with it.
#include <fmt/format.h>

#include <map>

#include "core/error.h"
#include "exchange/bags/bag.h"
#include "exchange/bags/rosbag_records.h"
#if FLEXTIP_HAS_ROSBAG
#include <rosbag/bag.h>
#include <rosbag/view.h>
#endif

namespace flextip::exchange {

#if FLEXTIP_HAS_ROSBAG
namespace {

class RosBag : public Bag {
 public:
  explicit RosBag(const std::filesystem::path& file) : file_(file.string()) {
    CheckRosBagRecords(file);
    Guarded([&] {
      bag_.open(file_, rosbag::bagmode::Read);
      rosbag::View view(bag_);
      for (const rosbag::ConnectionInfo* connection : view.getConnections()) Add(*connection);
      for (const rosbag::MessageInstance& message : view) {
        ++topics_[places_.at(message.getTopic())].messages;
      }
    });
  }

  const std::vector<BagTopic>& Topics() const override { return topics_; }

  void Read(const std::set<std::string>& topics,
            const std::function<void(const BagMessage&)>& take) const override {
    Guarded([&] {
      const std::vector<std::string> names(topics.begin(), topics.end());
      rosbag::View view(bag_, rosbag::TopicQuery(names));
      std::vector<std::uint8_t> bytes;
      for (const rosbag::MessageInstance& message : view) {
        bytes.resize(message.size());
        ros::serialization::OStream stream(bytes.data(), message.size());
        message.write(stream);
        const auto received_ns = static_cast<TimeNs>(message.getTime().toNSec());
        take({topics_[places_.at(message.getTopic())], received_ns, bytes});
      }
    });
  }

 private:
  template <class Work>
  void Guarded(Work work) const {
    try {
      work();
    } catch (const InputError&) {
      throw;
    } catch (const WorkError&) {
      throw;
    } catch (const std::exception&) {  // of the bag's library, whose words say less
      throw InputError::At(file_, 0,
                           "cannot be read as a bag: it is cut off or damaged (rosbag reindex "
                           "mends one that a crashed recorder left)");
    }
  }

  void Add(const rosbag::ConnectionInfo& connection) {
    if (!places_.emplace(connection.topic, topics_.size()).second) return;  // several publish it
    topics_.push_back({connection.topic, connection.datatype, WireFormat::kRos1, 0});
  }

  std::string file_;
  mutable rosbag::Bag bag_;  // its views read from it
  std::vector<BagTopic> topics_;
  std::map<std::string, std::size_t> places_;  // of the topics
};

}  // namespace

std::unique_ptr<Bag> OpenRosBag(const std::filesystem::path& file) {
  return std::make_unique<RosBag>(file);
}
#else
std::unique_ptr<Bag> OpenRosBag(const std::filesystem::path& file) {
  throw InputError::At(file.string(), 0,
                       "is a bag of ROS 1, and flextip was built without what reads it: install "
                       "librosbag-storage-dev and build again");
}
#endif

}  // namespace flextip::exchange
