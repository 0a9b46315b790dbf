#include "live/joints/joint_session.h"

#include <fmt/format.h>

#include "core/error.h"
#include "live/session/address.h"
#include "live/session/plausible.h"
#include "recording/text/yaml_map.h"

namespace flextip::live {
namespace {

Address RequiredAddress(const YamlMap& map, const std::string& key, Content content,
                        std::vector<YamlMap>& sections) {
  sections.push_back(map.Map(key));
  const YamlMap section = sections.back();
  const auto address = ReadAddress(section, sections, content);
  if (!address || !address->protocol->takes_commands)
    throw map.Error(key, "found no peer that takes commands, expected ros2");
  return *address;
}

std::vector<double> LimitsIn(const YamlMap& map, const std::string& key) {
  if (!map.Has(key)) return {};
  const std::vector<double> limits = map.Numbers(key);
  for (const double limit : limits)
    if (!(limit > 0.0)) throw map.Error(key, fmt::format("found {}, expected above 0", limit));
  return limits;
}

}  // namespace

bool IsJointSession(const std::filesystem::path& file) { return YamlMap::Load(file).Has("joints"); }

JointSession ReadJointSession(const std::filesystem::path& file) {
  const YamlMap top = YamlMap::Load(file);
  if (const std::string found = top.Text("format"); found != "flextip-session")
    throw top.Error("format", fmt::format("found '{}', expected flextip-session", found));
  if (const auto found = top.Integer("version"); found != 1)
    throw top.Error("version", fmt::format("found {}, expected 1", found));
  JointSession session;
  session.file = file;
  std::vector<YamlMap> sections{top.Map("joints")};
  const YamlMap map = sections.front();
  session.desired = file.parent_path() / map.Text("desired");
  if (top.Has("model")) session.model = file.parent_path() / top.Text("model");
  session.measured = RequiredAddress(map, "measured", Content::kJoints, sections);
  session.command = RequiredAddress(map, "command", Content::kJoints, sections);
  session.state = RequiredAddress(map, "state", Content::kState, sections);
  if (map.Has("command_state"))
    session.command_state = RequiredAddress(map, "command_state", Content::kText, sections);
  session.rate_hz = NumberInOr(map, "rate_hz", kRate, session.rate_hz);
  session.stale_s = NumberInOr(map, "stale_s", kStale, session.stale_s);
  session.follow_limit = LimitsIn(map, "follow_limit");
  session.approach_rate = LimitsIn(map, "approach_rate");
  session.max_rate = LimitsIn(map, "max_rate");
  session.max_correction = LimitsIn(map, "max_correction");
  (void)top.Has("comment");
  top.RefuseUnknown();
  for (const YamlMap& section : sections) section.RefuseUnknown();
  return session;
}

}  // namespace flextip::live
