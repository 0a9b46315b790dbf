// Bags of ROS 1 and ROS 2: their containers, their messages, and all that an import makes of them.
#include "exchange/bags/bags.h"
#include "exchange/bags/messages.h"
#include "exchange/import.h"
#include "recording/recording_reader.h"
#include "tests/fuzz/files/input_folder.h"
#include "tests/fuzz/files/inputs.h"

namespace flextip {
namespace {

using exchange::BagMessage;
using exchange::WireReader;

/// Every reader of messages gets every message: a topic's type is the bag's word alone.
void ReadAsAll(const BagMessage& message) {
  const auto read = [&](auto reader) {
    try {
      reader(WireReader(message.data, message.topic.format));
    } catch (const exchange::WireError&) {
    }
  };
  read(exchange::ReadPoseStamped);
  read(exchange::ReadTransformStamped);
  read(exchange::ReadWrenchStamped);
  read(exchange::ReadJointState);
  read(exchange::ReadImage);
  read(exchange::ReadCompressedImage);
  read(exchange::ReadCameraInfo);
}

exchange::ImportPlan PlanOf(const std::filesystem::path& bag) {
  exchange::ImportPlan plan;
  plan.length_m = 0.6;
  plan.outer_diameter_m = 0.00238;
  plan.bending_stiffness_Nm2 = 0.304;
  plan.p_RP = Eigen::Vector3d(0.28, 0.0, 0.01);
  plan.sensors["em0"].numbers["distance_from_tip_m"] = {0.02};
  for (const char* stream : {"wrist0", "em0", "em1"}) {
    plan.sensors[stream].numbers["position_noise_m"] = {0.0001};
    plan.sensors[stream].numbers["orientation_noise_rad"] = {0.001};
  }
  plan.sensors["load0"].numbers["force_noise_N"] = {0.01};
  plan.bags = {bag};
  return plan;
}

int CheckBag(std::span<const std::uint8_t> input, const InputFolder& folder) {
  const auto file = folder.Write("input.bag", TextOf(input));
  const bool read = ReadsOrRefuses([&] {
    const exchange::Bags bags({file});
    std::map<std::string, exchange::Bags::Take> takes;
    for (const auto& topic : bags.Topics())
      takes[topic.name] = [](const BagMessage& message, long) { ReadAsAll(message); };
    bags.Read(takes);
  });
  if (!read) return 0;
  exchange::Imported imported;
  if (!ReadsOrRefuses([&] { imported = exchange::Import(PlanOf(file)); })) return 0;
  std::filesystem::remove_all(folder / "recording");
  if (!ReadsOrRefuses([&] { exchange::WriteImported(folder / "recording", imported); })) return 0;
  ReadRecording(folder / "recording", {.check_frames = false});
  return 1;
}

bool IsOfRos1(std::span<const std::uint8_t> input) { return TextOf(input).starts_with("#ROSBAG"); }

}  // namespace

int CheckMcapInput(std::span<const std::uint8_t> input) {
  static const InputFolder folder;
  return IsOfRos1(input) ? 0 : CheckBag(input, folder);
}

int CheckRosBagInput(std::span<const std::uint8_t> input) {
  static const InputFolder folder;
  return IsOfRos1(input) ? CheckBag(input, folder) : 0;
}

}  // namespace flextip
