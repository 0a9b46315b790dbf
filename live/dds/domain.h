// A participant in a domain of DDS. Private to dds.
#pragma once

#include <dds/dds.h>

#include <memory>
#include <string>

namespace flextip::live {

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
  dds_entity_t NewParticipant() const;

 private:
  Ros2Domain(int domain, std::string network, bool quick);

  int domain_;
  std::string network_;
  dds_entity_t entity_ = 0;  // 0: the environment's, or somebody else's in this process
};

/// Returns what the library last said in this thread, or the name of the error.
std::string DdsProblem(dds_return_t error);

}  // namespace flextip::live
