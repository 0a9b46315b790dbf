// A participant in a domain of DDS. Private to dds.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

namespace flextip::live {

/// As the library has them: of entities (0: none, negative: an error) and of remote ones.
using DdsHandle = std::int32_t;
using DdsInstance = std::uint64_t;

/// The domain of this process, which its participants share. Messages of the library go nowhere;
/// errors are told with the exception.
class Ros2Domain {
 public:
  /// Opens the domain on a network interface, by name or address; "lo" keeps to this machine, empty
  /// is the library's choice. Where the environment has CYCLONEDDS_URI, that alone is followed.
  /// `quick`: reliable readers are asked every millisecond what they have. Throws WorkError, also
  /// where the domain is open on another interface.
  static std::shared_ptr<Ros2Domain> Open(int domain, const std::string& network, bool quick);
  ~Ros2Domain();
  Ros2Domain(const Ros2Domain&) = delete;
  Ros2Domain& operator=(const Ros2Domain&) = delete;

  /// Returns a new participant, to be deleted by the caller.
  DdsHandle NewParticipant() const;

 private:
  Ros2Domain(int domain, std::string network, bool quick);

  int domain_;
  std::string network_;
  DdsHandle entity_ = 0;  // 0: the environment's, or somebody else's in this process
};

/// Returns what the library last said in this thread, or the name of the error.
std::string DdsProblem(DdsHandle error);

}  // namespace flextip::live
