// tags0/sensor.yaml: the tag collar.
#include <set>

#include "recording/streams/sensor_head.h"
#include "recording/streams/sensor_streams.h"
#include "recording/text/text.h"

namespace flextip {

TagCollar ReadTags(const std::filesystem::path& folder, ReadLog& log) {
  return ReadCollarFile(folder / "sensor.yaml", log);
}

TagCollar ReadCollarFile(const std::filesystem::path& file, ReadLog& log) {
  const auto yaml = YamlMap::Load(file);
  for (const char* usual : {"sensor_type", "comment", "rate_hz"}) (void)yaml.Has(usual);
  TagCollar collar{yaml.Text("family"), {}};
  std::set<std::int64_t> ids;
  for (const auto& tag : yaml.Maps("tags")) {
    const auto id = tag.Integer("id");
    if (id < 0 || id > 1'000'000)
      throw tag.Error("id", fmt::format("found {}, expected an id", id));
    if (!ids.insert(id).second) throw tag.Error("id", fmt::format("tag {} is there twice", id));
    collar.tags.push_back({static_cast<int>(id), tag.Positive("size_m"), tag.Transform("T_EG")});
    tag.WarnUnknown(log);
  }
  if (collar.tags.empty()) throw yaml.Error("tags", "found none, expected at least one tag");
  yaml.WarnUnknown(log);
  return collar;
}

void WriteTags(const std::filesystem::path& folder, const TagCollar& collar) {
  std::string text = fmt::format("sensor_type: tags\nfamily: {}\ntags:\n", YamlText(collar.family));
  for (const auto& tag : collar.tags) {
    text += fmt::format("  - {{id: {}, size_m: {}, T_EG: {}}}\n", tag.id, YamlNumber(tag.size_m),
                        YamlTransform(tag.T_EG));
  }
  WriteTextFile(folder / "sensor.yaml", text);
}

}  // namespace flextip
