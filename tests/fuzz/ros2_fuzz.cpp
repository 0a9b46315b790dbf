// libFuzzer's entry for ROS 2's messages (clang, FLEXTIP_FUZZ).
#include <cstddef>
#include <cstdint>

#include "tests/fuzz/ros2_input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  flextip::CheckRos2Input({data, size});
  return 0;
}
