#include "exchange/bags/decompress.h"

#include <fmt/format.h>

#include "core/error.h"
#include "recording/text/text.h"
#if FLEXTIP_HAS_LZ4
#include <lz4frame.h>
#endif
#if FLEXTIP_HAS_ZSTD
#include <zstd.h>
#endif

namespace flextip::exchange {
namespace {

constexpr std::uint64_t kMostUnpacked = 1ULL << 31;  // a chunk is some megabytes

[[maybe_unused]] InputError BuiltWithout(const char* library, const char* package) {
  return InputError(
      fmt::format("the bag is compressed by {}, and flextip was built without it: "
                  "install {} and build again",
                  library, package));
}

#if FLEXTIP_HAS_LZ4
bool UnpackLz4(Bytes packed, std::vector<std::uint8_t>& unpacked) {
  LZ4F_dctx* context = nullptr;
  if (LZ4F_isError(LZ4F_createDecompressionContext(&context, LZ4F_VERSION)) != 0U) return false;
  std::size_t done = 0, at = 0;
  bool good = true;
  while (good && done < unpacked.size() && at < packed.size()) {
    std::size_t room = unpacked.size() - done, taken = packed.size() - at;
    const std::size_t status = LZ4F_decompress(context, unpacked.data() + done, &room,
                                               packed.data() + at, &taken, nullptr);
    good = LZ4F_isError(status) == 0U && (room > 0 || taken > 0);
    done += room;
    at += taken;
  }
  LZ4F_freeDecompressionContext(context);
  return good && done == unpacked.size();
}
#endif

}  // namespace

std::vector<std::uint8_t> Decompress([[maybe_unused]] Bytes packed, const std::string& compression,
                                     std::uint64_t size) {
  if (size > kMostUnpacked) throw WireError("a chunk states a size of more than 2 GiB");
  std::vector<std::uint8_t> unpacked(size);
  [[maybe_unused]] bool good = false;
  if (compression == "lz4") {
#if FLEXTIP_HAS_LZ4
    good = UnpackLz4(packed, unpacked);
#else
    throw BuiltWithout("lz4", "liblz4-dev");
#endif
  } else if (compression == "zstd") {
#if FLEXTIP_HAS_ZSTD
    good = ZSTD_decompress(unpacked.data(), unpacked.size(), packed.data(), packed.size()) == size;
#else
    throw BuiltWithout("zstd", "libzstd-dev");
#endif
  } else {
    throw WireError(
        fmt::format("found the compression {}, expected lz4 or zstd", Quoted(compression)));
  }
  if (!good) throw WireError("a chunk cannot be unpacked");
  return unpacked;
}

}  // namespace flextip::exchange
