#include "exchange/bags/rosbag_records.h"

#include <cstdint>
#include <fstream>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "core/error.h"
#include "recording/text/text.h"

namespace flextip::exchange {
namespace {

enum Op : std::uint8_t {
  kMessage = 2,
  kBagHeader = 3,
  kIndex = 4,
  kChunk = 5,
  kChunkInfo = 6,
  kConnection = 7
};

constexpr std::uint64_t kMagicSize = 13;
constexpr std::uint64_t kMostUnpacked = 1ULL << 28;  // a chunk is some megabytes

/// What was found, without the file's name.
class Damage : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

std::uint64_t Little(std::string_view bytes) {
  std::uint64_t value = 0;
  for (std::size_t i = bytes.size(); i-- > 0;)
    value = value << 8 | static_cast<unsigned char>(bytes[i]);
  return value;
}

/// A record's header: values by their names.
class Fields {
 public:
  explicit Fields(std::string_view header) {
    while (!header.empty()) {
      if (header.size() < 4) throw Damage("a record's header is cut off");
      const std::uint64_t size = Little(header.substr(0, 4));
      header.remove_prefix(4);
      if (size > header.size()) throw Damage("a field is longer than its record's header");
      const std::string_view field = header.substr(0, size);
      header.remove_prefix(size);
      const auto equals = field.find('=');
      if (equals == std::string_view::npos) throw Damage("a field has no value");
      values_[std::string(field.substr(0, equals))] = field.substr(equals + 1);
    }
  }

  std::uint64_t Number(const std::string& name, std::size_t size) const {
    const auto value = values_.find(name);
    if (value == values_.end() || value->second.size() != size)
      throw Damage("a record has no " + name);
    return Little(value->second);
  }
  std::string Text(const std::string& name) const {
    const auto value = values_.find(name);
    return value == values_.end() ? "" : value->second;
  }

 private:
  std::map<std::string, std::string> values_;
};

/// The places of the message records in an uncompressed chunk.
std::set<std::uint64_t> MessagesIn(std::string_view chunk) {
  std::set<std::uint64_t> places;
  std::size_t at = 0;
  const auto take = [&](std::uint64_t count) {
    if (count > chunk.size() - at) throw Damage("a record is longer than its chunk");
    const std::string_view taken = chunk.substr(at, count);
    at += count;
    return taken;
  };
  while (at < chunk.size()) {
    const std::uint64_t place = at;
    const Fields fields(take(Little(take(4))));
    const std::string_view data = take(Little(take(4)));
    const std::uint64_t op = fields.Number("op", 1);
    if (op == kMessage) places.insert(place);
    if (op == kConnection) (void)Fields(data);
  }
  return places;
}

class Walk {
 public:
  explicit Walk(const std::filesystem::path& file)
      : in_(OpenFile(file)), size_(std::filesystem::file_size(file)) {}

  void Check() {
    at_ = kMagicSize;
    in_.seekg(kMagicSize);
    while (at_ < size_) CheckRecord();
    if (index_ != 0 && index_ != size_ && !places_.contains(index_))
      throw Damage("the index is not where it is said to be");
    for (const std::uint64_t place : chunks_told_) {
      if (!chunks_.contains(place)) throw Damage("the index names a chunk that is not there");
    }
  }

 private:
  void Need(std::uint64_t count) const {
    if (count > size_ - at_) throw Damage("a record is longer than the file");
  }
  std::string Take(std::uint64_t count) {
    Need(count);
    std::string bytes(count, '\0');
    in_.read(bytes.data(), static_cast<std::streamsize>(count));
    if (!in_) throw Damage("cannot be read");
    at_ += count;
    return bytes;
  }
  void Skip(std::uint64_t count) {
    Need(count);
    in_.seekg(static_cast<std::streamoff>(count), std::ios::cur);
    at_ += count;
  }

  void CheckRecord() {
    const std::uint64_t place = at_;
    places_.insert(place);
    const Fields fields(Take(Little(Take(4))));
    const std::uint64_t data_size = Little(Take(4));
    switch (fields.Number("op", 1)) {
      case kBagHeader:
        index_ = fields.Number("index_pos", 8);
        return Skip(data_size);
      case kChunk:
        chunks_.insert(place);
        return TakeChunk(fields, data_size);
      case kIndex:
        return CheckIndex(fields, Take(data_size));
      case kChunkInfo:
        chunks_told_.insert(fields.Number("chunk_pos", 8));
        if (data_size != 8 * fields.Number("count", 4)) throw Damage("a count is wrong");
        return Skip(data_size);
      case kConnection:
        (void)Fields(Take(data_size));
        return;
      default:
        return Skip(data_size);
    }
  }

  void TakeChunk(const Fields& fields, std::uint64_t data_size) {
    unpacked_ = fields.Number("size", 4);
    messages_.reset();
    if (fields.Text("compression") != "none") {
      if (unpacked_ > kMostUnpacked) throw Damage("a chunk states a size of more than 256 MiB");
      return Skip(data_size);
    }
    if (unpacked_ != data_size) throw Damage("a chunk's size is wrong");
    messages_ = MessagesIn(Take(data_size));
  }

  /// The indices of a chunk follow it: a time and a place within it for each message.
  void CheckIndex(const Fields& fields, const std::string& data) const {
    const std::uint64_t count = fields.Number("count", 4);
    if (data.size() != 12 * count) throw Damage("a count is wrong");
    for (std::uint64_t i = 0; i < count; ++i) {
      const std::uint64_t place = Little(std::string_view(data).substr(12 * i + 8, 4));
      if (place >= unpacked_ || (messages_ && !messages_->contains(place)))
        throw Damage("the index names a message that is not there");
    }
  }

  std::ifstream in_;
  std::uint64_t size_, at_ = 0, index_ = 0;
  std::set<std::uint64_t> places_;                   ///< of all records
  std::set<std::uint64_t> chunks_, chunks_told_;     ///< their places
  std::uint64_t unpacked_ = 0;                       ///< bytes of the last chunk
  std::optional<std::set<std::uint64_t>> messages_;  ///< of the last chunk; empty: compressed
};

}  // namespace

void CheckRosBagRecords(const std::filesystem::path& file) {
  try {
    Walk(file).Check();
  } catch (const Damage& damage) {
    throw InputError::At(file.string(), 0,
                         fmt::format("cannot be read as a bag: {} (rosbag reindex mends one that a "
                                     "crashed recorder left)",
                                     damage.what()));
  }
}

}  // namespace flextip::exchange
