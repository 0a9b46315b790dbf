// A session file while it is read: its sections, and the files beside it. Private to session/.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "live/session/session.h"
#include "recording/text/yaml_map.h"

namespace flextip::live {

struct SessionFile {
  /// Returns the map behind `key`, and remembers it, to find the keys nobody asked for.
  YamlMap Section(const YamlMap& map, const std::string& key) {
    sections.push_back(map.Map(key));
    return sections.back();
  }
  /// Returns the file of that name beside the session's, or in `other_folder`; notes its name.
  std::filesystem::path Beside(const std::string& name) {
    session.named_files.emplace_back(name);
    const std::filesystem::path beside = file.parent_path() / name;
    if (other_folder.empty() || std::filesystem::exists(beside)) return beside;
    return other_folder / name;
  }

  std::filesystem::path file, other_folder;
  YamlMap top;
  std::vector<YamlMap> sections;
  Session session;  ///< as far as it is read
};

/// Reads `sources`: streams, their noises, the camera. Throws InputError with file and line.
void ReadSources(SessionFile& file);

}  // namespace flextip::live
