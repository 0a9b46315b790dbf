// Whether the records of a bag of ROS 1 lie where they say. The library that reads bags takes their
// lengths and places for granted: a damaged one asks for gigabytes, or is read beyond its end.
#pragma once

#include <filesystem>

namespace flextip::exchange {

/// Walks over the records of a bag of format 2.0 (wiki.ros.org/Bags/Format/2.0). Throws InputError
/// where a record does not fit into the file or the chunk that holds it, and where an index points
/// at no message. Of a compressed chunk only the stated size is checked.
void CheckRosBagRecords(const std::filesystem::path& file);

}  // namespace flextip::exchange
