// A URDF's chain of joints (wiki.ros.org/urdf/XML).
#include <algorithm>
#include <map>
#include <set>
#include <sstream>

#include "core/error.h"
#include "core/rotation.h"
#include "recording/arm/arm_file.h"
#include "recording/text/bounds.h"
#include "recording/text/text.h"
#include "recording/text/xml.h"

namespace flextip {
namespace {

constexpr std::size_t kMostUrdfJoints = 32;      // of the chain
constexpr std::size_t kMostJointsInFile = 1000;  // a humanoid has some 100

struct UrdfJoint {
  std::string name, type, parent, child;
  Pose origin;
  Eigen::Vector3d axis = Eigen::Vector3d::UnitX();
  long line = 0;
};

class Urdf {
 public:
  explicit Urdf(const std::filesystem::path& file) : file_(file.string()) {
    top_ = ReadXml(file);
    if (top_.name != "robot") throw Error(top_.line, "expected <robot>");
    for (const XmlElement& e : top_.children)
      if (e.name == "joint") AddJoint(e);
    if (joints_.empty()) throw Error(top_.line, "found no joint");
  }

  /// The joints from the root to `tip`, in this order.
  std::vector<UrdfJoint> Chain(const std::string& tip) const {
    std::vector<UrdfJoint> longest;
    for (const auto& [child, joint] : joints_) {
      if (!tip.empty() && child != tip) continue;
      std::vector<UrdfJoint> chain = To(child);
      if (Movable(chain) > Movable(longest)) longest = std::move(chain);
    }
    if (longest.empty())
      throw Error(top_.line, tip.empty() ? "found no joint that moves" : "found no link " + tip);
    return longest;
  }

  std::optional<ArmLink> Link(const std::string& name) const {
    for (const XmlElement& e : top_.children) {
      if (e.name != "link" || Attribute(e, "name") != name) continue;
      const XmlElement* inertial = e.Child("inertial");
      if (inertial == nullptr || inertial->Child("mass") == nullptr) return {};
      const XmlElement& mass = *inertial->Child("mass");
      ArmLink link{Numbers(mass, "value", 1)[0], Eigen::Vector3d::Zero()};
      const Bounds bounds = BoundsOf("mass_kg");
      if (link.mass_kg < 0.0 || link.mass_kg > bounds.most) {
        throw Error(mass.line, fmt::format("link {}: found a mass of {:g} kg, expected 0 to {:g}",
                                           name, link.mass_kg, bounds.most));
      }
      if (const XmlElement* origin = inertial->Child("origin")) link.com_m = Origin(*origin).p;
      return link;
    }
    return {};
  }

  InputError Error(long line, const std::string& what) const {
    return InputError::At(file_, line, what);
  }

 private:
  static int Movable(const std::vector<UrdfJoint>& chain) {
    return int(std::count_if(chain.begin(), chain.end(),
                             [](const UrdfJoint& joint) { return joint.type != "fixed"; }));
  }

  std::string Attribute(const XmlElement& e, const std::string& key) const {
    const auto found = e.attributes.find(key);
    if (found == e.attributes.end())
      throw Error(e.line, fmt::format("<{}> has no {}", e.name, key));
    return found->second;
  }

  std::vector<double> Numbers(const XmlElement& e, const std::string& key,
                              std::size_t count) const {
    std::istringstream stream(Attribute(e, key));
    std::vector<double> numbers;
    for (std::string word; stream >> word;) {
      char* end = nullptr;
      const double value = std::strtod(word.c_str(), &end);
      if (*end != '\0' || !(std::abs(value) < 1e6))
        throw Error(e.line, fmt::format("{}: found {}, expected a number", key, Quoted(word)));
      numbers.push_back(value);
    }
    if (numbers.size() != count) {
      throw Error(e.line,
                  fmt::format("{}: found {} numbers, expected {}", key, numbers.size(), count));
    }
    return numbers;
  }

  Pose Origin(const XmlElement& e) const {
    Pose origin;
    if (e.attributes.contains("xyz")) origin.p = Eigen::Vector3d::Map(Numbers(e, "xyz", 3).data());
    if (e.attributes.contains("rpy")) {
      const auto rpy = Numbers(e, "rpy", 3);
      origin.R =
          ExpRotation({0, 0, rpy[2]}) * ExpRotation({0, rpy[1], 0}) * ExpRotation({rpy[0], 0, 0});
    }
    return origin;
  }

  void AddJoint(const XmlElement& e) {
    static const std::set<std::string> known{"revolute", "continuous", "prismatic", "fixed"};
    UrdfJoint joint;
    joint.line = e.line;
    joint.name = Attribute(e, "name");
    joint.type = Attribute(e, "type");
    if (!known.contains(joint.type)) {
      throw Error(e.line, fmt::format("joint {}: found type {}, expected revolute, continuous, "
                                      "prismatic or fixed",
                                      joint.name, Quoted(joint.type)));
    }
    if (!e.Child("parent") || !e.Child("child"))
      throw Error(e.line, fmt::format("joint {} has no parent or no child", joint.name));
    joint.parent = Attribute(*e.Child("parent"), "link");
    joint.child = Attribute(*e.Child("child"), "link");
    if (const XmlElement* origin = e.Child("origin")) joint.origin = Origin(*origin);
    if (const XmlElement* axis = e.Child("axis"))
      joint.axis = Eigen::Vector3d::Map(Numbers(*axis, "xyz", 3).data());
    if (joint.axis.norm() < 1e-6) throw Error(e.line, fmt::format("joint {}: no axis", joint.name));
    joint.axis.normalize();
    if (joints_.size() == kMostJointsInFile) {
      throw Error(e.line, fmt::format("found more than {} joints", kMostJointsInFile));
    }
    if (!joints_.emplace(joint.child, joint).second)
      throw Error(e.line, fmt::format("link {} has two parents", joint.child));
  }

  std::vector<UrdfJoint> To(std::string child) const {
    std::vector<UrdfJoint> chain;
    for (auto found = joints_.find(child); found != joints_.end(); found = joints_.find(child)) {
      if (chain.size() > joints_.size())
        throw Error(found->second.line, fmt::format("link {} is its own ancestor", child));
      chain.push_back(found->second);
      child = found->second.parent;
    }
    std::reverse(chain.begin(), chain.end());
    return chain;
  }

  std::string file_;
  XmlElement top_;
  std::map<std::string, UrdfJoint> joints_;  ///< by their child
};

}  // namespace

Arm ReadUrdf(const std::filesystem::path& file, const std::string& tip, ReadLog& log) {
  const Urdf urdf(file);
  Arm arm;
  arm.convention = ArmConvention::kUrdf;
  Pose fixed;
  std::vector<std::optional<ArmLink>> links;
  for (const UrdfJoint& joint : urdf.Chain(tip)) {
    fixed = fixed * joint.origin;
    if (joint.type == "fixed") continue;
    ArmJoint own;
    own.name = joint.name;
    own.type = joint.type == "prismatic" ? JointType::kPrismatic : JointType::kRevolute;
    own.before = fixed;
    own.axis = joint.axis;
    arm.joints.push_back(own);
    links.push_back(urdf.Link(joint.child));
    fixed = {};
  }
  if (arm.joints.size() > kMostUrdfJoints)
    throw urdf.Error(
        0, fmt::format("found {} joints, expected {} at most", arm.joints.size(), kMostUrdfJoints));
  arm.joints.back().after = fixed;
  const bool all =
      std::all_of(links.begin(), links.end(), [](const auto& link) { return link.has_value(); });
  if (all) {
    for (const auto& link : links) arm.links.push_back(*link);
  } else {
    log.warnings.push_back(
        fmt::format("{}: not every link has a mass, all are taken as unknown", file.string()));
  }
  return arm;
}

}  // namespace flextip
