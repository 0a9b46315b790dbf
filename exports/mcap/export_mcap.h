// A recording or a result as an MCAP file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace flextip::exports {

struct McapContent {
  struct Topic {
    std::string topic, schema;
    std::uint64_t messages = 0;
  };
  std::vector<Topic> topics;
  std::uint64_t messages = 0;
  std::vector<std::string> warnings;
};

/// Writes FOLDER's tables, poses, paths, pictures with what is drawn over them, camera and frames
/// into FILE; beside them the tables of `more` (results of the recording), under their folders'
/// names. Calls `progress` with messages written and their total. Throws InputError where a folder
/// cannot be read, WorkError where the disk refuses.
McapContent ExportMcap(const std::filesystem::path& folder,
                       const std::vector<std::filesystem::path>& more,
                       const std::filesystem::path& file,
                       const std::function<void(std::size_t done, std::size_t all)>& progress = {});

}  // namespace flextip::exports
