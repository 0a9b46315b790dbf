#include "exchange/bags/topics.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

#include "exchange/list_text.h"
#include "exchange/streams/names.h"

namespace flextip::exchange {
namespace {

/// A topic that may be a stream; the lowest rank fits best.
struct Candidate {
  const BagTopic* topic = nullptr;
  int rank = 0;
};
using Candidates = std::map<std::string, std::vector<Candidate>>;  ///< of each stream

constexpr int kNoGuess = -1;

struct Guess {
  std::string stream;
  int rank = kNoGuess;
};

std::string LeafOf(const std::string& topic) { return topic.substr(topic.rfind('/') + 1); }

bool HasWord(const std::string& topic, const std::string& word) {
  const auto words = WordsOf(topic);
  return std::find(words.begin(), words.end(), word) != words.end();
}

Guess GuessPose(const std::string& topic) {
  const std::string leaf = LeafOf(topic);
  const int local = HasWord(topic, "local") ? 1 : 0;  // CRTK: in the frame of the arm's base
  if (leaf == "setpoint_cp") return {"command0", local};
  if (leaf == "servo_cp") return {"command0", 2 + local};
  if (leaf == "move_cp" || leaf == "interpolate_cp" || leaf == "goal_cp") return {"command0", 4};
  const std::string by_name = StreamNamed(topic);
  if (leaf == "measured_cp") {
    const bool tracker = by_name == "em0" || by_name == "em1";
    return {tracker ? by_name : "wrist0", local};
  }
  if (leaf == "position_cartesian_current") return {"wrist0", 0};  // CRTK's forerunner
  if (by_name == "strain0" || by_name == "load0") return {};
  return {by_name, by_name.empty() ? kNoGuess : 2};
}

Guess GuessJoints(const std::string& topic) {
  const std::string leaf = LeafOf(topic);
  if (HasWord(topic, "jaw") || HasWord(topic, "gripper")) return {};
  if (leaf == "measured_js" || leaf == "state_joint_current") return {"joints0", 0};
  if (leaf == "joint_states") return {"joints0", 1};
  if (leaf == "setpoint_js" || leaf == "state_joint_desired") return {"joints_command0", 0};
  if (leaf == "servo_js") return {"joints_command0", 1};
  return {};
}

Guess GuessPicture(const BagTopic& topic) {
  if (HasWord(topic.name, "rect") || HasWord(topic.name, "depth")) return {};
  const bool packed = topic.type == "sensor_msgs/CompressedImage";
  return {HasWord(topic.name, "right") ? "cam1" : "cam0", packed ? 1 : 0};
}

Guess GuessStream(const BagTopic& topic) {
  switch (KindOfType(topic.type)) {
    case TopicKind::kPose:
      return GuessPose(topic.name);
    case TopicKind::kJoints:
      return GuessJoints(topic.name);
    case TopicKind::kPicture:
      return GuessPicture(topic);
    case TopicKind::kWrench:  // CRTK's measured_cf is a guess from motor currents
      return LeafOf(topic.name) == "measured_cf" ? Guess{} : Guess{"load0", 0};
    default:
      return {};
  }
}

bool Fits(const std::string& stream, TopicKind kind) {
  if (IsCamera(stream)) return kind == TopicKind::kPicture;
  if (IsJointStream(stream)) return kind == TopicKind::kJoints;
  if (stream == "load0") return kind == TopicKind::kWrench;
  return stream != "strain0" && kind == TopicKind::kPose;
}

const BagTopic* FindTopic(const std::vector<BagTopic>& topics, const std::string& name) {
  const auto found = std::find_if(topics.begin(), topics.end(),
                                  [&](const BagTopic& topic) { return topic.name == name; });
  return found == topics.end() ? nullptr : &*found;
}

std::string NamesOf(const std::vector<Candidate>& candidates) {
  std::string names;
  for (const auto& c : candidates) AppendItem(names, c.topic->name);
  return names;
}

/// Chooses for one stream after the other.
class TopicChoice {
 public:
  TopicChoice(const std::vector<BagTopic>& topics, ImportPlan& plan, ImportLog& log)
      : topics_(topics), plan_(plan), log_(log) {}

  void Run() {
    CheckTold();
    for (const BagTopic& topic : topics_) {
      const Guess guess = GuessStream(topic);
      if (topic.messages > 0 && guess.rank != kNoGuess && !guess.stream.empty()) {
        candidates_[guess.stream].push_back({&topic, guess.rank});
      }
    }
    if (IsOfArmAlone(plan_)) {
      std::erase_if(candidates_, [](const auto& entry) { return !IsJointStream(entry.first); });
    }
    for (const char* first : {"wrist0", "joints0"}) Choose(first);  // others follow its namespace
    for (const auto& [stream, candidates] : candidates_) Choose(stream);
    SayUnused();
  }

 private:
  void CheckTold() {
    const auto check = [&](const std::string& stream, const std::string& name) {
      if (name.empty()) return;
      const BagTopic* topic = FindTopic(topics_, name);
      if (topic == nullptr) {
        std::string names;
        for (const auto& t : topics_) AppendItem(names, t.name);
        throw InputError(fmt::format("{}: found no topic {} in the bag, expected one of {}", stream,
                                     name, names));
      }
      if (!Fits(stream, KindOfType(topic->type))) {
        throw InputError(fmt::format("{}: {} is of type {}, which is not read as {}", stream, name,
                                     topic->type, stream));
      }
      used_.insert(name);
    };
    for (const auto& [name, stream] : plan_.streams) check(name, stream.topic);
    for (const auto& [name, camera] : plan_.cameras) check(name, camera.topic);
  }

  bool IsPlanned(const std::string& stream) const {
    if (IsCamera(stream)) {
      const auto camera = plan_.cameras.find(stream);
      return camera != plan_.cameras.end() &&
             !(camera->second.topic.empty() && camera->second.video.empty());
    }
    const auto found = plan_.streams.find(stream);
    return found != plan_.streams.end() &&
           !(found->second.topic.empty() && found->second.file.empty());
  }

  std::string ArmNamespace() const {
    for (const char* stream : {"wrist0", "joints0"}) {
      const auto told = plan_.streams.find(stream);
      if (told != plan_.streams.end() && !told->second.topic.empty())
        return NamespaceOf(told->second.topic);
    }
    return "";
  }

  void Choose(const std::string& stream) {
    const auto found = candidates_.find(stream);
    if (found == candidates_.end() || IsPlanned(stream)) return;
    std::vector<Candidate> best = found->second;
    if (const std::string arm = ArmNamespace(); !arm.empty()) {
      const bool of_arm = stream == "command0" || IsJointStream(stream);
      std::vector<Candidate> near;
      for (const auto& c : best) {
        if (NamespaceOf(c.topic->name) == arm) near.push_back(c);
      }
      if (!near.empty() || of_arm) best = near;
    }
    int rank = 1000;
    for (const auto& c : best) rank = std::min(rank, c.rank);
    std::erase_if(best, [&](const Candidate& c) { return c.rank > rank; });
    if (best.empty()) return;
    if (best.size() > 1) return Several(stream, best);
    const std::string& topic = best.front().topic->name;
    (IsCamera(stream) ? plan_.cameras[stream].topic : plan_.streams[stream].topic) = topic;
    log_.Assume(stream + ".topic", topic + ", by its name");
    used_.insert(topic);
  }

  void Several(const std::string& stream, const std::vector<Candidate>& best) {
    const std::string what = fmt::format("{} may be {}", stream, NamesOf(best));
    if (stream == "wrist0") {
      log_.missing.push_back({what, {"topics." + stream}});
    } else {
      log_.Warn(fmt::format("{}: none is taken (--stream {}=TOPIC)", what, stream));
    }
  }

  void SayUnused() {
    std::string names;
    for (const BagTopic& topic : topics_) {
      const TopicKind kind = KindOfType(topic.type);
      if (kind == TopicKind::kOther || kind == TopicKind::kCameraInfo) continue;
      if (!used_.contains(topic.name)) AppendItem(names, topic.name);
    }
    if (!names.empty()) log_.Warn("topics not used: " + names);
  }

  const std::vector<BagTopic>& topics_;
  ImportPlan& plan_;
  ImportLog& log_;
  Candidates candidates_;
  std::set<std::string> used_;
};

}  // namespace

TopicKind KindOfType(const std::string& type) {
  static const std::map<std::string, TopicKind> kinds{
      {"geometry_msgs/PoseStamped", TopicKind::kPose},
      {"geometry_msgs/TransformStamped", TopicKind::kPose},
      {"geometry_msgs/WrenchStamped", TopicKind::kWrench},
      {"sensor_msgs/JointState", TopicKind::kJoints},
      {"sensor_msgs/Image", TopicKind::kPicture},
      {"sensor_msgs/CompressedImage", TopicKind::kPicture},
      {"sensor_msgs/CameraInfo", TopicKind::kCameraInfo}};
  const auto found = kinds.find(type);
  return found == kinds.end() ? TopicKind::kOther : found->second;
}

std::string NamespaceOf(const std::string& topic) {
  const auto slash = topic.rfind('/');
  return slash == std::string::npos ? "" : topic.substr(0, slash);
}

void ChooseTopics(const std::vector<BagTopic>& topics, ImportPlan& plan, ImportLog& log) {
  TopicChoice(topics, plan, log).Run();
}

}  // namespace flextip::exchange
