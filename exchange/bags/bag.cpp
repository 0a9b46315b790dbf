#include "exchange/bags/bag.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <string_view>

#include "core/error.h"
#include "recording/text/text.h"

namespace flextip::exchange {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kRosBagMagic = "#ROSBAG V2.0\n", kMcapMagic = "\x89MCAP0\r\n",
                           kSqliteMagic = "SQLite format 3";

std::string HeadOf(const fs::path& file) {
  std::ifstream in = OpenFile(file);
  std::array<char, 16> head{};
  in.read(head.data(), head.size());
  return {head.data(), static_cast<std::size_t>(in.gcount())};
}

std::vector<fs::path> McapFilesIn(const fs::path& folder) {
  std::vector<fs::path> files;
  bool sqlite = false;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (entry.path().extension() == ".mcap") files.push_back(entry.path());
    sqlite = sqlite || entry.path().extension() == ".db3";
  }
  if (files.empty()) {
    throw InputError::At(folder.string(), 0,
                         sqlite ? "holds a bag in SQLite, expected MCAP: ros2 bag convert makes one"
                                : "holds no .mcap file, expected the folder of a ROS 2 bag");
  }
  std::sort(files.begin(), files.end());
  return files;
}

}  // namespace

std::unique_ptr<Bag> OpenBag(const fs::path& path) {
  if (!fs::exists(path)) throw InputError::At(path.string(), 0, "no such file, expected a bag");
  if (fs::is_directory(path)) return OpenMcap(McapFilesIn(path));
  const std::string head = HeadOf(path);
  if (head.starts_with(kRosBagMagic)) return OpenRosBag(path);
  if (head.starts_with(kMcapMagic)) return OpenMcap({path});
  if (head.starts_with(kSqliteMagic)) {
    throw InputError::At(path.string(), 0,
                         "is a bag in SQLite, expected MCAP: ros2 bag convert makes one");
  }
  if (head.starts_with("#ROSBAG")) {
    throw InputError::At(path.string(), 0, "is a bag of another version, expected 2.0");
  }
  throw InputError::At(path.string(), 0, "is no bag, expected one of ROS 1 (.bag) or MCAP");
}

}  // namespace flextip::exchange
