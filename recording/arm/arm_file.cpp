#include "recording/arm/arm_file.h"

#include "core/error.h"
#include "core/rotation.h"
#include "recording/text/text.h"
#include "recording/text/yaml_map.h"

namespace flextip {
namespace {

constexpr const char* kArmFormat = "flextip-arm";
constexpr int kArmVersion = 1;
constexpr std::size_t kMostJoints = 32;

void CheckArmFormat(const YamlMap& yaml) {
  if (const auto format = yaml.Text("format"); format != kArmFormat)
    throw yaml.Error("format", fmt::format("found {}, expected {}", Quoted(format), kArmFormat));
  if (const auto version = yaml.Integer("version"); version != kArmVersion) {
    throw yaml.Error(
        "version", fmt::format("found the unknown version {}, expected {}", version, kArmVersion));
  }
}

ArmConvention ReadConvention(const YamlMap& yaml) {
  const std::string name = yaml.Text("convention");
  if (name == "modified-dh") return ArmConvention::kModifiedDh;
  if (name == "dh") return ArmConvention::kDh;
  throw yaml.Error("convention", fmt::format("found {}, expected modified-dh or dh", Quoted(name)));
}

ArmJoint ReadJoint(const YamlMap& yaml, ArmConvention convention, ReadLog& log) {
  ArmJoint joint;
  const std::string type = yaml.Text("type");
  if (type != "revolute" && type != "prismatic")
    throw yaml.Error("type", fmt::format("found {}, expected revolute or prismatic", Quoted(type)));
  joint.type = type == "revolute" ? JointType::kRevolute : JointType::kPrismatic;
  joint.name = yaml.TextOr("name", "");
  joint.a_m = yaml.Number("a_m");
  joint.alpha_rad = yaml.Number("alpha_rad");
  joint.d_m = yaml.Number("d_m");
  joint.theta_rad = yaml.Number("theta_rad");
  yaml.WarnUnknown(log);
  PlaceJoint(convention, joint);
  return joint;
}

PayloadPlace ReadPlace(const YamlMap& yaml, int joints, ReadLog& log) {
  PayloadPlace place;
  place.name = yaml.Text("name");
  if (yaml.Has("keeps_orientation_of")) {
    const auto frame = yaml.Integer("keeps_orientation_of");
    if (frame < 1 || frame >= joints) {
      throw yaml.Error("keeps_orientation_of",
                       fmt::format("found {}, expected 1 to {}", frame, joints - 1));
    }
    place.keeps_orientation_of = static_cast<int>(frame);
    const auto bar = yaml.Numbers("bar_m", 2);
    place.bar_m = {bar[0], bar[1]};
    place.along_m = yaml.Number("along_m");
  } else {
    const auto link = yaml.Integer("link");
    if (link < 1 || link > joints)
      throw yaml.Error("link", fmt::format("found {}, expected 1 to {}", link, joints));
    place.link = static_cast<int>(link);
    place.p_m = yaml.Vector3("p_m");
  }
  yaml.WarnUnknown(log);
  return place;
}

std::string JointText(const ArmJoint& joint) {
  return fmt::format("  - {{type: {}{}, a_m: {}, alpha_rad: {}, d_m: {}, theta_rad: {}}}\n",
                     joint.type == JointType::kRevolute ? "revolute" : "prismatic",
                     joint.name.empty() ? "" : ", name: " + YamlText(joint.name),
                     YamlNumber(joint.a_m), YamlNumber(joint.alpha_rad), YamlNumber(joint.d_m),
                     YamlNumber(joint.theta_rad));
}

std::string PlaceText(const PayloadPlace& place) {
  if (place.keeps_orientation_of > 0) {
    return fmt::format("  - {{name: {}, keeps_orientation_of: {}, bar_m: {}, along_m: {}}}\n",
                       YamlText(place.name), place.keeps_orientation_of,
                       YamlNumbers({place.bar_m.x(), place.bar_m.y()}), YamlNumber(place.along_m));
  }
  return fmt::format("  - {{name: {}, link: {}, p_m: {}}}\n", YamlText(place.name), place.link,
                     YamlNumbers({place.p_m.x(), place.p_m.y(), place.p_m.z()}));
}

}  // namespace

void PlaceJoint(ArmConvention convention, ArmJoint& joint) {
  const Pose across{ExpRotation({joint.alpha_rad, 0.0, 0.0}), {joint.a_m, 0.0, 0.0}};
  // Along and about the same axis: the joint's own number moves one, the other is fixed.
  const bool turns = joint.type == JointType::kRevolute;
  const Pose along = turns
                         ? Pose{Eigen::Matrix3d::Identity(), {0.0, 0.0, joint.d_m}}
                         : Pose{ExpRotation({0.0, 0.0, joint.theta_rad}), Eigen::Vector3d::Zero()};
  joint.axis = Eigen::Vector3d::UnitZ();
  joint.zero = turns ? joint.theta_rad : joint.d_m;
  if (convention == ArmConvention::kModifiedDh) {
    joint.before = Pose{across.R, across.p} * along;
    joint.after = {};
  } else {
    joint.before = along;
    joint.after = across;
  }
}

Arm ReadArm(const std::filesystem::path& file, ReadLog& log) {
  if (file.extension() == ".urdf") return ReadUrdf(file, "", log);
  const auto yaml = YamlMap::Load(file);
  CheckArmFormat(yaml);
  Arm arm;
  arm.convention = ReadConvention(yaml);
  for (const YamlMap& joint : yaml.Maps("joints"))
    arm.joints.push_back(ReadJoint(joint, arm.convention, log));
  if (arm.joints.empty() || arm.joints.size() > kMostJoints) {
    throw yaml.Error(
        "joints", fmt::format("found {} joints, expected 1 to {}", arm.joints.size(), kMostJoints));
  }
  if (yaml.Has("T_RB")) arm.T_RB = yaml.Transform("T_RB");
  if (yaml.Has("T_LK")) arm.T_LK = yaml.Transform("T_LK");
  if (yaml.Has("links")) {
    for (const YamlMap& link : yaml.Maps("links")) {
      arm.links.push_back({link.NonNegative("mass_kg"), link.Vector3("com_m")});
      link.WarnUnknown(log);
    }
    if (!arm.links.empty() && arm.links.size() != arm.joints.size()) {
      throw yaml.Error("links", fmt::format("found {} links, expected {}: one a joint",
                                            arm.links.size(), arm.joints.size()));
    }
  }
  if (yaml.Has("payload_places")) {
    for (const YamlMap& place : yaml.Maps("payload_places"))
      arm.payload_places.push_back(ReadPlace(place, arm.Size(), log));
  }
  (void)yaml.Has("comment");
  yaml.WarnUnknown(log);
  return arm;
}

void WriteArm(const std::filesystem::path& file, const Arm& arm) {
  if (arm.convention == ArmConvention::kUrdf) {
    throw WorkError(fmt::format("{}: an arm from a URDF has no numbers of Denavit and Hartenberg",
                                file.string()));
  }
  std::string text =
      fmt::format("format: {}\nversion: {}\nconvention: {}\njoints:\n", kArmFormat, kArmVersion,
                  arm.convention == ArmConvention::kModifiedDh ? "modified-dh" : "dh");
  for (const ArmJoint& joint : arm.joints) text += JointText(joint);
  if (!arm.T_RB.Matrix().isIdentity(0.0)) text += "T_RB: " + YamlTransform(arm.T_RB) + "\n";
  if (arm.T_LK) text += "T_LK: " + YamlTransform(*arm.T_LK) + "\n";
  if (!arm.links.empty()) text += "links:\n";
  for (const ArmLink& link : arm.links) {
    text += fmt::format("  - {{mass_kg: {}, com_m: {}}}\n", YamlNumber(link.mass_kg),
                        YamlNumbers({link.com_m.x(), link.com_m.y(), link.com_m.z()}));
  }
  if (!arm.payload_places.empty()) text += "payload_places:\n";
  for (const PayloadPlace& place : arm.payload_places) text += PlaceText(place);
  WriteTextFile(file, text);
}

}  // namespace flextip
