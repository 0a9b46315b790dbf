#include "exchange/formats/bag_pictures.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "exchange/bags/camera_info.h"
#include "exchange/bags/pictures.h"
#include "exchange/bags/topics.h"
#include "exchange/formats/camera.h"
#include "exchange/values/times.h"

namespace flextip::exchange {
namespace {

namespace fs = std::filesystem;

ImageMessage ReadPictureMessage(const BagMessage& message) {
  const WireReader wire(message.data, message.topic.format);
  return message.topic.type == "sensor_msgs/Image" ? ReadImage(wire) : ReadCompressedImage(wire);
}

// The CameraInfo beside the pictures: "/left/camera_info" of "/left/image_raw/compressed". Empty
// where there is none.
std::string InfoTopicOf(const std::string& pictures, const Bags& bags) {
  for (std::string space = NamespaceOf(pictures); !space.empty(); space = NamespaceOf(space)) {
    const BagTopic* topic = bags.Find(space + "/camera_info");
    if (topic != nullptr && KindOfType(topic->type) == TopicKind::kCameraInfo) return topic->name;
  }
  return "";
}

}  // namespace

BagPictures::BagPictures(std::string name, const CameraPlan& plan, const Bags& bags)
    : name_(std::move(name)),
      topic_(plan.topic),
      info_topic_(plan.camera.empty() ? InfoTopicOf(plan.topic, bags) : ""),
      offset_ns_(plan.offset_ns.value_or(0)) {}

void BagPictures::Want(std::map<std::string, Bags::Take>& takes) {
  takes[topic_] = [this](const BagMessage& message, long number) { TakePicture(message, number); };
  if (info_topic_.empty()) return;
  takes[info_topic_] = [this](const BagMessage& message, long number) {
    if (number == 1) TakeInfo(message);
  };
}

void BagPictures::TakePicture(const BagMessage& message, long number) {
  const ImageMessage picture = ReadPictureMessage(message);
  if (pictures_.empty()) {
    width_px_ = picture.width_px;
    height_px_ = picture.height_px;
    stamped_ = picture.header.stamp_ns != 0;
  }
  const TimeNs t_ns = stamped_ ? picture.header.stamp_ns : message.received_ns;
  const auto sum = WithOffset(t_ns, offset_ns_);
  if (!sum)
    throw InputError(fmt::format("{}: message {}: the time {} ns is beyond what a recording holds",
                                 topic_, number, t_ns));
  pictures_.push_back({*sum, number, PictureSuffix(picture)});
}

void BagPictures::TakeInfo(const BagMessage& message) {
  info_ = ReadCameraInfo(WireReader(message.data, message.topic.format));
}

void BagPictures::SortPictures(ImportLog& log) {
  if (pictures_.empty()) throw InputError(topic_ + ": no messages");
  if (!stamped_) {
    log.Assume(name_ + ".stamp", "the recorder's times: the messages carry none of their own");
  }
  std::stable_sort(pictures_.begin(), pictures_.end(),
                   [](const Picture& a, const Picture& b) { return a.t_ns < b.t_ns; });
  const auto repeated =
      std::unique(pictures_.begin(), pictures_.end(),
                  [](const Picture& a, const Picture& b) { return a.t_ns == b.t_ns; });
  if (repeated != pictures_.end()) {
    log.Warn(fmt::format("{}: {}: left out {} pictures with the time of the one before", name_,
                         topic_, pictures_.end() - repeated));
  }
  pictures_.erase(repeated, pictures_.end());
}

bool BagPictures::Finish(CameraPlan& plan, const std::shared_ptr<const Bags>& bags,
                         Streams& streams, ImportLog& log) {
  SortPictures(log);
  CameraStream camera;
  if (!plan.camera.empty()) {
    camera = ReadCameraOf(name_, plan, width_px_, height_px_, log);
    plan.camera = fs::absolute(plan.camera).lexically_normal();
  } else {
    const auto lens = info_ ? CameraOf(*info_, info_topic_, topic_) : std::nullopt;
    if (!lens) return false;
    camera = PlaceCamera(name_, plan, *lens, log);
  }
  std::map<long, std::string> files;  // of the messages
  for (const Picture& picture : pictures_) {
    const std::string file = fmt::format("{}{}", picture.t_ns, picture.suffix);
    files[picture.number] = file;
    camera.filenames.push_back({picture.t_ns, file});
  }
  camera.comment = "pictures of " + topic_;
  TakeFrameRate(camera);
  streams.writers.emplace_back([bags, files, topic = topic_, name = name_](const fs::path& folder) {
    bags->Read({{topic, [&](const BagMessage& message, long number) {
                   const auto file = files.find(number);
                   if (file == files.end()) return;
                   WritePicture(folder / name / "data" / file->second, ReadPictureMessage(message));
                 }}});
  });
  (name_ == "cam0" ? streams.recording.cam0 : streams.recording.cam1) = std::move(camera);
  return true;
}

}  // namespace flextip::exchange
