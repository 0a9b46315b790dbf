#include "tests/live/dds/cdr.h"

#include <dds/dds.h>
#include <dds/ddsi/ddsi_serdata.h>
#include <dds/ddsi/ddsi_sertype.h>
#include <ros2.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <memory>
#include <string>

#include "live/dds/domain.h"
#include "live/dds/messages.h"
#include "tests/live/dds/domain_of_tests.h"

namespace flextip::live {
namespace {

const dds_topic_descriptor_t& DescriptorOf(Ros2Type type) {
  static const std::array<const dds_topic_descriptor_t*, kRos2Types> all{
      &geometry_msgs_msg_dds__PoseStamped__desc,
      &geometry_msgs_msg_dds__TransformStamped__desc,
      &geometry_msgs_msg_dds__PoseWithCovarianceStamped__desc,
      &sensor_msgs_msg_dds__JointState__desc,
      &geometry_msgs_msg_dds__WrenchStamped__desc,
      &sensor_msgs_msg_dds__Image__desc,
      &crtk_msgs_msg_dds__OperatingState__desc,
      &crtk_msgs_msg_dds__StringStamped__desc,
      &std_msgs_msg_dds__String__desc,
      &sensor_msgs_msg_dds__JointState__desc,
  };
  return *all[static_cast<std::size_t>(type)];
}

/// A topic of each type that is read and written in this process alone. The library tells its
/// types only with samples.
class Topics {
 public:
  Topics() : domain_(Ros2Domain::Open(DomainOfTests(), "lo", false)) {
    participant_ = domain_->NewParticipant();
    for (int i = 0; i < kRos2Types; ++i) {
      const auto& descriptor = DescriptorOf(static_cast<Ros2Type>(i));
      const std::string name = "cdr" + std::to_string(i);
      const dds_entity_t topic =
          dds_create_topic(participant_, &descriptor, name.c_str(), nullptr, nullptr);
      const auto at = static_cast<std::size_t>(i);
      readers_[at] = dds_create_reader(participant_, topic, nullptr, nullptr);
      writers_[at] = dds_create_writer(participant_, topic, nullptr, nullptr);
      std::vector<char> zeros(descriptor.m_size);
      types_[at] = ddsi_sertype_ref(Cdr(static_cast<Ros2Type>(i), zeros.data())->type);
    }
  }
  Topics(const Topics&) = delete;
  Topics& operator=(const Topics&) = delete;
  ~Topics() {
    for (ddsi_sertype* type : types_) ddsi_sertype_unref(type);
    dds_delete(participant_);
  }

  using Data = std::unique_ptr<ddsi_serdata, void (*)(ddsi_serdata*)>;
  /// Writes and takes a sample.
  Data Cdr(Ros2Type type, const void* sample) {
    const auto at = static_cast<std::size_t>(type);
    if (dds_write(writers_[at], sample) != DDS_RETCODE_OK) std::abort();
    ddsi_serdata* data = nullptr;
    dds_sample_info_t info{};
    if (dds_takecdr(readers_[at], &data, 1, &info, DDS_ANY_STATE) != 1) std::abort();
    return {data, [](ddsi_serdata* d) { ddsi_serdata_unref(d); }};
  }
  const ddsi_sertype* Of(Ros2Type type) const { return types_[static_cast<std::size_t>(type)]; }

 private:
  std::shared_ptr<Ros2Domain> domain_;
  dds_entity_t participant_;
  std::array<dds_entity_t, kRos2Types> readers_{}, writers_{};
  std::array<ddsi_sertype*, kRos2Types> types_{};
};

Topics& AllTopics() {
  static Topics topics;
  return topics;
}

}  // namespace

void WithCdr(Ros2Type type, std::span<const std::uint8_t> bytes, bool big_endian,
             const std::function<void(const void*)>& use) {
  std::vector<std::uint8_t> all{0, static_cast<std::uint8_t>(big_endian ? 0 : 1), 0, 0};
  all.insert(all.end(), bytes.begin(), bytes.end());
  while (all.size() % 4 != 0) {
    all.push_back(0);
    ++all[3];  // how many bytes were added
  }
  const ddsi_sertype* const known = AllTopics().Of(type);
  ddsrt_iovec_t part{};
  part.iov_base = all.data();
  part.iov_len = all.size();
  ddsi_serdata* const data = ddsi_serdata_from_ser_iov(known, SDK_DATA, 1, &part, all.size());
  if (data == nullptr) return;
  void* const sample = ddsi_sertype_alloc_sample(known);
  if (ddsi_serdata_to_sample(data, sample, nullptr, nullptr)) use(sample);
  ddsi_sertype_free_sample(known, sample, DDS_FREE_ALL);
  ddsi_serdata_unref(data);
}

std::vector<std::uint8_t> CdrOf(Ros2Type type, const WireMessage& message) {
  std::vector<std::uint8_t> bytes;
  WithRos2(type, message, [&](const void* sample) {
    const auto data = AllTopics().Cdr(type, sample);
    ddsrt_iovec_t part{};
    const std::uint32_t size = ddsi_serdata_size(data.get());
    ddsi_serdata* const held = ddsi_serdata_to_ser_ref(data.get(), 0, size, &part);
    const auto* const begin = static_cast<const std::uint8_t*>(part.iov_base);
    bytes.assign(begin + 4, begin + size - (begin[3] & 3));
    ddsi_serdata_to_ser_unref(held, &part);
  });
  return bytes;
}

const char* WireName(Ros2Type type) { return DescriptorOf(type).m_typename; }

}  // namespace flextip::live
