// libFuzzer's entry (clang, FLEXTIP_FUZZ): compiled once for each reader, FLEXTIP_FUZZ_CHECK is the
// function of its NAME_input.h.
#include <cstddef>
#include <cstdint>
#include <span>

namespace flextip {
int FLEXTIP_FUZZ_CHECK(std::span<const std::uint8_t> input);
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  flextip::FLEXTIP_FUZZ_CHECK({data, size});
  return 0;
}
