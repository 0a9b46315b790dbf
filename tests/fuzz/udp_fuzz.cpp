// libFuzzer's entry for the reader of JSON datagrams (clang, FLEXTIP_FUZZ).
#include <cstddef>
#include <cstdint>

#include "tests/fuzz/udp_input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  flextip::CheckUdpInput({data, size});
  return 0;
}
