#include "exchange/bags/decompress.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

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

/// A buffer that grows with what is unpacked: a chunk's stated size alone asks for no memory.
class Unpacked {
 public:
  explicit Unpacked(std::uint64_t size) : size_(size) { Grow(); }

  bool Full() const { return done_ == size_; }
  std::uint8_t* Place() { return bytes_.data() + done_; }
  std::size_t Room() const { return bytes_.size() - done_; }
  void Add(std::size_t count) {
    done_ += count;
    if (Room() == 0) Grow();
  }
  std::vector<std::uint8_t> Take() { return std::move(bytes_); }

 private:
  void Grow() { bytes_.resize(std::min<std::uint64_t>(size_, 2 * done_ + kFirst)); }

  static constexpr std::uint64_t kFirst = 1U << 16;
  std::uint64_t size_, done_ = 0;
  std::vector<std::uint8_t> bytes_;
};

#if FLEXTIP_HAS_LZ4
bool UnpackLz4(Bytes packed, Unpacked& unpacked) {
  LZ4F_dctx* context = nullptr;
  if (LZ4F_isError(LZ4F_createDecompressionContext(&context, LZ4F_VERSION)) != 0U) return false;
  std::size_t at = 0;
  bool good = true;
  while (good && !unpacked.Full() && at < packed.size()) {
    std::size_t room = unpacked.Room(), taken = packed.size() - at;
    const std::size_t status =
        LZ4F_decompress(context, unpacked.Place(), &room, packed.data() + at, &taken, nullptr);
    good = LZ4F_isError(status) == 0U && (room > 0 || taken > 0);
    unpacked.Add(room);
    at += taken;
  }
  LZ4F_freeDecompressionContext(context);
  return good && unpacked.Full();
}
#endif

#if FLEXTIP_HAS_ZSTD
bool UnpackZstd(Bytes packed, Unpacked& unpacked) {
  ZSTD_DCtx* context = ZSTD_createDCtx();
  if (context == nullptr) return false;
  ZSTD_inBuffer in{packed.data(), packed.size(), 0};
  bool good = true;
  while (good && !unpacked.Full()) {
    ZSTD_outBuffer out{unpacked.Place(), unpacked.Room(), 0};
    const std::size_t before = in.pos;
    const std::size_t status = ZSTD_decompressStream(context, &out, &in);
    good = ZSTD_isError(status) == 0U && (out.pos > 0 || in.pos > before);
    unpacked.Add(out.pos);
  }
  ZSTD_freeDCtx(context);
  return good;
}
#endif

}  // namespace

std::vector<std::uint8_t> Decompress([[maybe_unused]] Bytes packed, const std::string& compression,
                                     std::uint64_t size) {
  if (size > kMostUnpacked) throw WireError("a chunk states a size of more than 2 GiB");
  Unpacked unpacked(size);
  [[maybe_unused]] bool good = false;
  if (compression == "lz4") {
#if FLEXTIP_HAS_LZ4
    good = UnpackLz4(packed, unpacked);
#else
    throw BuiltWithout("lz4", "liblz4-dev");
#endif
  } else if (compression == "zstd") {
#if FLEXTIP_HAS_ZSTD
    good = UnpackZstd(packed, unpacked);
#else
    throw BuiltWithout("zstd", "libzstd-dev");
#endif
  } else {
    throw WireError(
        fmt::format("found the compression {}, expected lz4 or zstd", Quoted(compression)));
  }
  if (!good) throw WireError("a chunk cannot be unpacked");
  return unpacked.Take();
}

}  // namespace flextip::exchange
