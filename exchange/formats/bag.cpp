// Topics of ROS bags as streams and cameras.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "exchange/bags/topics.h"
#include "exchange/formats/bag_pictures.h"
#include "exchange/formats/formats.h"
#include "exchange/streams/joints.h"
#include "exchange/streams/names.h"
#include "exchange/streams/series.h"
#include "exchange/values/times.h"

namespace flextip::exchange {
namespace {

NumbersMessage ReadNumbers(const BagMessage& message) {
  const WireReader wire(message.data, message.topic.format);
  const std::string& type = message.topic.type;
  if (type == "geometry_msgs/PoseStamped") return ReadPoseStamped(wire);
  if (type == "geometry_msgs/TransformStamped") return ReadTransformStamped(wire);
  if (type == "geometry_msgs/WrenchStamped") return ReadWrenchStamped(wire);
  return ReadJointState(wire);
}

/// The messages of one stream.
struct StreamMessages {
  std::string stream, topic;
  std::vector<NumbersMessage> messages;
  std::vector<TimeNs> t_ns;          ///< while reading: the recorder's
  std::vector<std::size_t> in_time;  ///< places in the order of times

  /// Takes the stamps for times; the recorder's times where the first message has no stamp.
  void Stamp(const StreamPlan& plan, ImportLog& log) {
    if (messages.empty()) throw InputError(topic + ": no messages");
    const bool stamped = messages.front().header.stamp_ns != 0;
    if (!stamped) {
      log.Assume(stream + ".stamp", "the recorder's times: the messages carry none of their own");
    }
    for (std::size_t i = 0; i < messages.size(); ++i) {
      if (stamped) t_ns[i] = messages[i].header.stamp_ns;
      const auto sum = WithOffset(t_ns[i], plan.offset_ns.value_or(0));
      if (!sum)
        throw InputError(
            fmt::format("{}: message {}: the time {} ns is beyond what a recording holds", topic,
                        i + 1, t_ns[i]));
      t_ns[i] = *sum;
    }
    in_time.resize(t_ns.size());
    std::iota(in_time.begin(), in_time.end(), std::size_t{0});
    std::stable_sort(in_time.begin(), in_time.end(),
                     [&](std::size_t a, std::size_t b) { return t_ns[a] < t_ns[b]; });
  }
};

StreamRows RowsOf(const StreamMessages& read) {
  std::vector<std::string> roles{"x", "y", "z", "qx", "qy", "qz", "qw"};
  if (read.stream == "load0") roles = {"fx", "fy", "fz"};
  if (read.stream == "command0") roles.resize(3);
  RowTaker taker(read.stream, roles);
  for (const std::size_t i : read.in_time) {
    std::vector<double> values = read.messages[i].values;
    values.resize(roles.size());
    taker.Take(read.t_ns[i], static_cast<long>(i + 1), std::move(values));
  }
  StreamRows rows = taker.Finish();
  rows.source = read.topic;
  if (rows.t_ns.empty()) throw InputError(read.topic + ": no message holds a whole set of values");
  return rows;
}

void AddPoses(const StreamMessages& read, StreamPlan& plan, Streams& streams, ImportLog& log) {
  const bool force = read.stream == "load0";
  plan.units.try_emplace(force ? "force" : "length", force ? "N" : "m");
  plan.orientation = force || read.stream == "command0" ? "" : "quaternion";
  StreamRows rows = RowsOf(read);
  ToSi(read.stream, rows, plan, log);
  SayRows(read.stream, rows, log);
  streams.skipped[read.stream] = rows.missing + rows.repeated;
  AddStream(read.stream, rows, plan, streams.recording, log);
  const std::string& frame = read.messages.front().header.frame;
  if (!frame.empty()) {
    log.Assume(read.stream + ".frame", fmt::format("R is the frame {} of its messages", frame));
  }
}

JointSeries JointsOf(const StreamMessages& read, long& left_out) {
  const auto values_of = [&](const NumbersMessage& message) {
    return read.stream == "torque0" ? message.effort : message.position;
  };
  JointSeries series{read.stream, read.messages.front().joints, {}, {}};
  const std::size_t count = values_of(read.messages.front()).size();
  if (count == 0) throw InputError(fmt::format("{}: holds no values of joints", read.topic));
  for (std::size_t i = series.names.size(); i < count; ++i) {
    series.names.push_back(fmt::format("joint {}", i + 1));
  }
  series.names.resize(count);
  for (const std::size_t i : read.in_time) {
    std::vector<double> values = values_of(read.messages[i]);
    const bool whole =
        values.size() == count && std::all_of(values.begin(), values.end(),
                                              [](double value) { return std::isfinite(value); });
    if (!whole || (!series.t_ns.empty() && read.t_ns[i] <= series.t_ns.back())) {
      ++left_out;
      continue;
    }
    series.t_ns.push_back(read.t_ns[i]);
    series.values.push_back(std::move(values));
  }
  if (series.t_ns.empty()) throw InputError(read.topic + ": no message holds all joints");
  return series;
}

void AddJoints(const StreamMessages& read, const ImportPlan& plan, Streams& streams,
               ImportLog& log) {
  long& left_out = streams.skipped[read.stream];
  JointSeries series = JointsOf(read, left_out);
  if (left_out > 0) {
    log.Warn(
        fmt::format("{}: {}: left out {} messages without all joints, or with the time of "
                    "the one before",
                    read.stream, read.topic, left_out));
  }
  const JointStream joints = TakeJoints(std::move(series), plan, log);
  streams.others.push_back(Describe(joints));
  streams.writers.emplace_back(
      [joints](const std::filesystem::path& folder) { WriteJoints(folder, joints); });
}

// A camera that was only guessed is left out where nothing tells its lens.
void FinishPictures(const std::string& name, BagPictures& pictures, ImportPlan& plan,
                    Streams& streams, ImportLog& log) {
  CameraPlan& camera = plan.cameras.at(name);
  if (pictures.Finish(camera, streams.bags, streams, log)) return;
  const std::string topic = camera.topic;
  if (log.assumed.erase(name + ".topic") == 0) {
    throw NotTold(fmt::format("{}: no CameraInfo beside {} tells its lens", name, topic),
                  {fmt::format("cameras.{}.camera", name)});
  }
  plan.cameras.erase(name);
  log.Warn(
      fmt::format("{}: {} is left out, since neither a CameraInfo nor a file tells its lens "
                  "(--camera)",
                  name, topic));
}

}  // namespace

void FindTopics(ImportPlan& plan, Streams& streams, ImportLog& log) {
  if (plan.bags.empty()) {
    for (const auto& [name, stream] : plan.streams) {
      if (stream.topic.empty()) continue;
      throw InputError(fmt::format("{}: found {}, expected a file", name, stream.topic));
    }
    return;
  }
  for (auto& file : plan.bags) file = std::filesystem::absolute(file).lexically_normal();
  streams.bags = std::make_shared<const Bags>(plan.bags);
  for (const auto& remark : streams.bags->Remarks()) log.Warn(remark);
  ChooseTopics(streams.bags->Topics(), plan, log);
}

void ReadBags(ImportPlan& plan, Streams& streams, ImportLog& log) {
  if (!streams.bags) return;
  std::map<std::string, Bags::Take> takes;
  std::map<std::string, StreamMessages> read;
  for (const auto& [name, stream] : plan.streams) {
    if (!stream.topic.empty()) read[name] = {name, stream.topic, {}, {}, {}};
  }
  std::map<std::string, std::vector<StreamMessages*>> of_topic;
  for (auto& [name, messages] : read) of_topic[messages.topic].push_back(&messages);
  for (const auto& [topic, list] : of_topic) {
    takes[topic] = [&list = list](const BagMessage& message, long) {
      for (StreamMessages* messages : list) {
        messages->messages.push_back(ReadNumbers(message));
        messages->t_ns.push_back(message.received_ns);
      }
    };
  }
  std::map<std::string, BagPictures> pictures;
  for (const auto& [name, camera] : plan.cameras) {
    if (camera.topic.empty()) continue;
    pictures.emplace(name, BagPictures(name, camera, *streams.bags)).first->second.Want(takes);
  }
  streams.bags->Read(takes);
  for (auto& [name, messages] : read) {
    log.Try([&, &name = name, &messages = messages] {
      messages.Stamp(plan.streams.at(name), log);
      if (IsJointStream(name)) return AddJoints(messages, plan, streams, log);
      AddPoses(messages, plan.streams.at(name), streams, log);
    });
  }
  for (auto& [name, list] : pictures) {
    log.Try([&, &name = name, &list = list] { FinishPictures(name, list, plan, streams, log); });
  }
}

}  // namespace flextip::exchange
