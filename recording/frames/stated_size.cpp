#include "recording/frames/stated_size.h"

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <fstream>
#include <string>
#include <string_view>

namespace flextip {
namespace {

using namespace std::string_view_literals;

constexpr std::streamsize kHead = 4096;  // a PGM's comments may come before its size

/// Takes an unsigned number of 2 or 4 bytes; 0 where there are fewer.
std::int64_t NumberAt(std::string_view bytes, std::size_t at, std::size_t size, bool big_endian) {
  if (at + size > bytes.size()) return 0;
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < size; ++i) {
    const std::size_t place = big_endian ? i : size - 1 - i;
    value = value << 8 | static_cast<unsigned char>(bytes[at + place]);
  }
  return value;
}

/// The height of a BMP is negative where its first line is the picture's top.
StatedSize OfBmp(std::string_view head) {
  if (NumberAt(head, 14, 4, false) == 12)  // of OS/2
    return {NumberAt(head, 18, 2, false), NumberAt(head, 20, 2, false)};
  const auto height = static_cast<std::int32_t>(NumberAt(head, 22, 4, false));
  return {NumberAt(head, 18, 4, false), std::llabs(height)};
}

/// The first two numbers after the kind, comments left out.
StatedSize OfPnm(std::string_view head) {
  std::int64_t numbers[2] = {0, 0};
  std::size_t at = 2;
  for (std::int64_t& number : numbers) {
    while (at < head.size() && (head[at] < '0' || head[at] > '9')) {
      if (head[at] == '#') at = std::min(head.find('\n', at), head.size() - 1);
      ++at;
    }
    const auto end = std::from_chars(head.data() + at, head.data() + head.size(), number);
    if (end.ec != std::errc()) return {};
    at = static_cast<std::size_t>(end.ptr - head.data());
  }
  return {numbers[0], numbers[1]};
}

/// The tags 256 and 257 of the first directory (TIFF 6.0, section 2).
StatedSize OfTiff(std::ifstream& in, std::string_view head) {
  const bool big_endian = head[0] == 'M';
  const std::int64_t from = NumberAt(head, 4, 4, big_endian);
  const std::int64_t entries = NumberAt(ReadBytes(in, from, 2), 0, 2, big_endian);
  const std::string directory = ReadBytes(in, from + 2, 12 * entries);
  StatedSize size;
  for (std::size_t at = 0; at + 12 <= directory.size(); at += 12) {
    const std::int64_t tag = NumberAt(directory, at, 2, big_endian);
    if (tag != 256 && tag != 257) continue;
    const bool is_short = NumberAt(directory, at + 2, 2, big_endian) == 3;
    const std::int64_t value = NumberAt(directory, at + 8, is_short ? 2 : 4, big_endian);
    (tag == 256 ? size.width_px : size.height_px) = value;
  }
  return size;
}

}  // namespace

std::string ReadBytes(std::ifstream& in, std::streamoff from, std::streamsize count) {
  std::string bytes(static_cast<std::size_t>(count), '\0');
  in.clear();
  in.seekg(from);
  in.read(bytes.data(), count);
  bytes.resize(static_cast<std::size_t>(in.gcount()));
  return bytes;
}

std::optional<StatedSize> ReadStatedSize(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  const std::string head = ReadBytes(in, 0, kHead);
  StatedSize size;
  if (head.starts_with("BM")) {
    size = OfBmp(head);
  } else if (head.size() > 2 && head[0] == 'P' && head[1] >= '1' && head[1] <= '6') {
    size = OfPnm(head);
  } else if (head.starts_with("II*\0"sv) || head.starts_with("MM\0*"sv)) {
    size = OfTiff(in, head);
  }
  if (size.width_px < 1 || size.height_px < 1) return {};
  return size;
}

}  // namespace flextip
