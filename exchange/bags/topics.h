// Which topics of bags are which streams.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "exchange/bags/bag.h"
#include "exchange/import_plan.h"

namespace flextip::exchange {

/// What the messages of a type can be.
enum class TopicKind : std::uint8_t { kOther, kPose, kWrench, kJoints, kPicture, kCameraInfo };
TopicKind KindOfType(const std::string& type);

/// The name without its last part: "/PSM1" of "/PSM1/measured_cp".
std::string NamespaceOf(const std::string& topic);

/// Gives the plan's streams and cameras the topics that their names tell (CRTK's, ROS drivers'):
/// those that have neither a file nor a topic. Of several that fit, the one of the wrist's
/// namespace counts. Says what was chosen and what is not used. Throws InputError for a told topic
/// that no bag holds or that cannot be its stream; a wrist that may be several topics is collected
/// as missing.
void ChooseTopics(const std::vector<BagTopic>& topics, ImportPlan& plan, ImportLog& log);

}  // namespace flextip::exchange
