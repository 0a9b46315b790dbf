#include "live/dds/endpoints.h"

#include <dds/dds.h>
#include <fmt/format.h>
#include <ros2.h>

#include <algorithm>
#include <array>
#include <type_traits>
#include <utility>

#include "core/error.h"

namespace flextip::live {
namespace {

constexpr int kLast = 10;              // messages kept, as ROS 2's default
constexpr int kLastInLockstep = 2000;  // no sample of a cycle is left out

struct QosDeleter {
  void operator()(dds_qos_t* qos) const { dds_delete_qos(qos); }
};
using Qos = std::unique_ptr<dds_qos_t, QosDeleter>;

/// ROS 2's default but for the writer's patience: a full queue must not hold up a cycle. In
/// lockstep what was sent before a reader was there is kept for it.
Qos QosOf(bool reliable, bool durable, int kept) {
  Qos qos(dds_create_qos());
  dds_qset_reliability(qos.get(), reliable ? DDS_RELIABILITY_RELIABLE : DDS_RELIABILITY_BEST_EFFORT,
                       0);
  dds_qset_durability(qos.get(),
                      durable ? DDS_DURABILITY_TRANSIENT_LOCAL : DDS_DURABILITY_VOLATILE);
  dds_qset_history(qos.get(), DDS_HISTORY_KEEP_LAST, kept);
  dds_qset_durability_service(qos.get(), 0, DDS_HISTORY_KEEP_LAST, kept, DDS_LENGTH_UNLIMITED,
                              DDS_LENGTH_UNLIMITED, DDS_LENGTH_UNLIMITED);
  const dds_data_representation_id_t xcdr1 = DDS_DATA_REPRESENTATION_XCDR1;
  dds_qset_data_representation(qos.get(), 1, &xcdr1);
  return qos;
}

/// Pictures are too large for more than the default.
int KeptOf(const EndpointPlace& place, Ros2Type type) {
  return place.lockstep && type != Ros2Type::kImage ? kLastInLockstep : kLast;
}

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

dds_entity_t Made(dds_entity_t made, const std::string& name) {
  if (made < 0) throw WorkError(fmt::format("ros2 {}: {}", name, DdsProblem(made)));
  return made;
}

dds_entity_t NewTopic(const EndpointPlace& place, const std::string& name, Ros2Type type) {
  return Made(dds_create_topic(place.participant, &DescriptorOf(type), ("rt/" + name).c_str(),
                               nullptr, nullptr),
              name);
}

/// A reader that is matched with a writer.
struct Matched {
  DdsInstance participant = 0;
  std::string beside;
};

std::vector<Matched> ReadersOf(dds_entity_t writer) {
  constexpr std::size_t kMost = 64;
  std::array<dds_instance_handle_t, kMost> handles{};
  const dds_return_t count = dds_get_matched_subscriptions(writer, handles.data(), kMost);
  std::vector<Matched> readers;
  for (std::size_t i = 0; i < kMost && i < static_cast<std::size_t>(std::max(count, 0)); ++i) {
    dds_builtintopic_endpoint_t* const data = dds_get_matched_subscription_data(writer, handles[i]);
    if (data == nullptr) continue;
    Matched& reader = readers.emplace_back();
    reader.participant = data->participant_instance_handle;
    void* beside = nullptr;
    std::size_t size = 0;
    if (dds_qget_userdata(data->qos, &beside, &size) && beside != nullptr)
      reader.beside.assign(static_cast<const char*>(beside), size);
    dds_free(beside);
    dds_builtintopic_free_endpoint(data);
  }
  return readers;
}

}  // namespace

std::string BesideOf(const std::vector<Ros2Topic>& topics) {
  std::string beside = "\n";
  for (const Ros2Topic& topic : topics) beside += topic.name + "\n";
  return beside;
}

static_assert(std::is_same_v<DdsHandle, dds_entity_t>);
static_assert(std::is_same_v<DdsInstance, dds_instance_handle_t>);

DdsEntity::~DdsEntity() {
  if (entity_ > 0) dds_delete(entity_);
}

Ros2Reader::Ros2Reader(const EndpointPlace& place, const std::string& name, Ros2Type type)
    : place_(place), type_(type), topic_(NewTopic(place, name, type)) {
  Open(true, place.lockstep);
}

void Ros2Reader::Open(bool reliable, bool durable) {
  reader_ = DdsEntity();
  const Qos qos = QosOf(reliable, durable, KeptOf(place_, type_));
  dds_qset_userdata(qos.get(), place_.beside.data(), place_.beside.size());
  reader_ = DdsEntity(
      Made(dds_create_reader(place_.participant, topic_.get(), qos.get(), nullptr), Name(type_)));
  reliable_ = reliable;
  durable_ = durable;
  writers_ = 0;
  participants_.clear();
  dds_set_status_mask(reader_.get(), DDS_DATA_AVAILABLE_STATUS | DDS_SUBSCRIPTION_MATCHED_STATUS |
                                         DDS_REQUESTED_INCOMPATIBLE_QOS_STATUS);
  dds_waitset_attach(place_.waitset, reader_.get(), 0);
}

void Ros2Reader::TakeAll(const Take& take) {
  constexpr std::uint32_t kAtOnce = 32;
  std::array<dds_sample_info_t, kAtOnce> infos;
  while (true) {
    std::array<void*, kAtOnce> samples{};
    const dds_return_t count =
        dds_take(reader_.get(), samples.data(), infos.data(), kAtOnce, kAtOnce);
    if (count <= 0) return;
    for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
      const dds_sample_info_t& info = infos[i];
      if (info.valid_data)
        take(type_, samples[i], info.source_timestamp, ParticipantOf(info.publication_handle));
    }
    dds_return_loan(reader_.get(), samples.data(), count);
  }
}

void Ros2Reader::LookAtStatus() {
  dds_subscription_matched_status_t matched{};
  dds_requested_incompatible_qos_status_t refused{};
  if (dds_get_subscription_matched_status(reader_.get(), &matched) == DDS_RETCODE_OK)
    writers_ = static_cast<int>(matched.current_count);
  if (dds_get_requested_incompatible_qos_status(reader_.get(), &refused) != DDS_RETCODE_OK) return;
  if (refused.total_count_change == 0) return;
  if (reliable_ && refused.last_policy_id == DDS_RELIABILITY_QOS_POLICY_ID) {
    Open(false, durable_);
  } else if (durable_ && refused.last_policy_id == DDS_DURABILITY_QOS_POLICY_ID) {
    Open(reliable_, false);
  }
}

bool Ros2Reader::IsWrittenBy(dds_instance_handle_t participant) const {
  constexpr std::size_t kMost = 64;
  std::array<dds_instance_handle_t, kMost> writers{};
  const dds_return_t count = dds_get_matched_publications(reader_.get(), writers.data(), kMost);
  for (std::size_t i = 0; i < kMost && i < static_cast<std::size_t>(std::max(count, 0)); ++i) {
    const auto known = participants_.find(writers[i]);
    if (known != participants_.end() && known->second == participant) return true;
  }
  return false;
}

/// Returns 0 for a writer that has gone already.
dds_instance_handle_t Ros2Reader::ParticipantOf(dds_instance_handle_t writer) {
  const auto known = participants_.find(writer);
  if (known != participants_.end()) return known->second;
  dds_builtintopic_endpoint_t* const data = dds_get_matched_publication_data(reader_.get(), writer);
  if (data == nullptr) return 0;
  constexpr std::size_t kMostKnown = 1000;
  if (participants_.size() >= kMostKnown) participants_.clear();
  const dds_instance_handle_t participant = data->participant_instance_handle;
  dds_builtintopic_free_endpoint(data);
  participants_[writer] = participant;
  return participant;
}

Ros2Writer::Ros2Writer(const EndpointPlace& place, const std::string& name, Ros2Type type)
    : name_(name), type_(type), topic_(NewTopic(place, name, type)) {
  const Qos qos = QosOf(true, place.lockstep, KeptOf(place, type));
  writer_ =
      DdsEntity(Made(dds_create_writer(place.participant, topic_.get(), qos.get(), nullptr), name));
  dds_set_status_mask(writer_.get(), DDS_PUBLICATION_MATCHED_STATUS);
  dds_waitset_attach(place.waitset, writer_.get(), 0);
}

bool Ros2Writer::Write(const void* sample) const {
  return dds_write(writer_.get(), sample) == DDS_RETCODE_OK;
}

void Ros2Writer::LookAtStatus() {
  dds_publication_matched_status_t matched{};
  if (dds_get_publication_matched_status(writer_.get(), &matched) == DDS_RETCODE_OK)
    readers_ = static_cast<int>(matched.current_count);
}

bool Ros2Writer::KnowsReadersOf(const Ros2Writer& other) const {
  const std::vector<Matched> known = ReadersOf(writer_.get());
  for (const Matched& reader : ReadersOf(other.writer_.get())) {
    if (reader.beside.find("\n" + name_ + "\n") == std::string::npos) continue;
    const bool here = std::any_of(known.begin(), known.end(), [&](const Matched& one) {
      return one.participant == reader.participant;
    });
    if (!here) return false;
  }
  return true;
}

bool Ros2Writer::WaitForReaders(std::chrono::nanoseconds patience) const {
  return dds_wait_for_acks(writer_.get(), patience.count()) == DDS_RETCODE_OK;
}

}  // namespace flextip::live
