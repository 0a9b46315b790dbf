// libFuzzer's entry for the OpenIGTLink codec (clang, FLEXTIP_FUZZ).
#include <cstddef>
#include <cstdint>

#include "tests/fuzz/openigtlink_input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  flextip::CheckOpenIgtLinkInput({data, size});
  return 0;
}
