// MCAP files (mcap.dev/spec): records of an opcode, a length and a content; chunks hold compressed
// records. Files are read from front to back, without their index: one that a crashed recorder left
// has none.
#include <fmt/format.h>

#include <array>
#include <fstream>
#include <map>

#include "core/error.h"
#include "exchange/bags/bag.h"
#include "exchange/bags/decompress.h"
#include "recording/text/text.h"

namespace flextip::exchange {
namespace {

namespace fs = std::filesystem;

enum Opcode : std::uint8_t { kSchema = 3, kChannel = 4, kMessage = 5, kChunk = 6, kDataEnd = 15 };

constexpr std::size_t kMagicSize = 8;

/// Takes little-endian numbers and counted texts off a record.
class RecordReader {
 public:
  explicit RecordReader(Bytes content) : rest_(content) {}

  std::uint64_t Number(std::size_t size) {
    const Bytes bytes = Take(size);
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < size; ++i) value |= std::uint64_t{bytes[i]} << (8 * i);
    return value;
  }
  std::string Text() {
    const Bytes bytes = Take(Number(4));
    return {bytes.begin(), bytes.end()};
  }
  Bytes Take(std::uint64_t count) {
    if (count > rest_.size()) throw WireError("a record is cut off");
    const Bytes taken = rest_.first(count);
    rest_ = rest_.subspan(count);
    return taken;
  }
  Bytes Rest() const { return rest_; }
  bool Empty() const { return rest_.empty(); }

 private:
  Bytes rest_;
};

using TakeRecord = std::function<void(std::uint8_t opcode, Bytes content)>;

std::uint32_t Crc32(Bytes bytes) {
  std::uint32_t crc = ~0U;
  for (const std::uint8_t byte : bytes) {
    crc ^= byte;
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1) ^ ((crc & 1U) != 0 ? 0xEDB88320U : 0U);
  }
  return ~crc;
}

void ReadChunk(Bytes content, const TakeRecord& take) {
  RecordReader chunk(content);
  (void)chunk.Take(16);  // first and last time
  const std::uint64_t size = chunk.Number(8);
  const auto crc = static_cast<std::uint32_t>(chunk.Number(4));
  const std::string compression = chunk.Text();
  const Bytes packed = chunk.Take(chunk.Number(8));
  std::vector<std::uint8_t> unpacked;
  Bytes records = packed;
  if (!compression.empty()) {
    unpacked = Decompress(packed, compression, size);
    records = unpacked;
  }
  if (crc != 0 && Crc32(records) != crc) throw WireError("a chunk's checksum is wrong");
  RecordReader reader(records);
  while (!reader.Empty()) {
    const auto opcode = static_cast<std::uint8_t>(reader.Number(1));
    take(opcode, reader.Take(reader.Number(8)));
  }
}

/// Calls `take` with every record, of chunks too. Returns false where the file ends before its end
/// of data.
bool ReadRecords(const fs::path& file, const TakeRecord& take) {
  std::ifstream in = OpenFile(file);
  const std::uintmax_t file_size = fs::file_size(file);
  in.seekg(kMagicSize);
  std::uintmax_t at = kMagicSize;
  std::vector<std::uint8_t> content;
  std::array<char, 9> head{};
  while (in.read(head.data(), head.size())) {
    at += head.size();
    const Bytes bytes(reinterpret_cast<const std::uint8_t*>(head.data()), head.size());
    RecordReader reader(bytes);
    const auto opcode = static_cast<std::uint8_t>(reader.Number(1));
    const std::uint64_t size = reader.Number(8);
    if (opcode == kDataEnd) return true;
    if (size > file_size - at) return false;
    at += size;
    content.resize(size);
    in.read(reinterpret_cast<char*>(content.data()), static_cast<std::streamsize>(size));
    if (!in) return false;  // cut off while it is read
    try {
      if (opcode == kChunk) {
        ReadChunk(content, take);
      } else {
        take(opcode, content);
      }
    } catch (const WireError& error) {
      throw InputError::At(file.string(), 0,
                           fmt::format("{} (at byte {})", error.what(), at - size));
    }
  }
  return false;
}

// "geometry_msgs/msg/PoseStamped" as ROS 1 has it.
std::string PlainType(std::string type) {
  const auto at = type.find("/msg/");
  if (at != std::string::npos) type.erase(at, 4);
  return type;
}

class McapBag : public Bag {
 public:
  explicit McapBag(std::vector<fs::path> files) : files_(std::move(files)) {
    channels_.resize(files_.size());
    for (std::size_t i = 0; i < files_.size(); ++i) ReadTopics(i);
  }

  const std::vector<BagTopic>& Topics() const override { return topics_; }

  void Read(const std::set<std::string>& topics,
            const std::function<void(const BagMessage&)>& take) const override {
    for (std::size_t i = 0; i < files_.size(); ++i) {
      ReadRecords(files_[i], [&](std::uint8_t opcode, Bytes content) {
        if (opcode != kMessage) return;
        RecordReader message(content);
        const auto channel = channels_[i].find(message.Number(2));
        if (channel == channels_[i].end()) return;
        const BagTopic& topic = topics_[channel->second];
        if (!topics.contains(topic.name)) return;
        (void)message.Number(4);  // sequence
        const auto received_ns = static_cast<TimeNs>(message.Number(8));
        (void)message.Number(8);  // publish time
        take({topic, received_ns, message.Rest()});
      });
    }
  }

 private:
  using Schemas = std::map<std::uint64_t, std::string>;

  void ReadTopics(std::size_t i) {
    Schemas schemas;
    const bool whole = ReadRecords(files_[i], [&](std::uint8_t opcode, Bytes content) {
      RecordReader record(content);
      if (opcode == kSchema) {
        const std::uint64_t id = record.Number(2);
        schemas[id] = PlainType(record.Text());
      } else if (opcode == kChannel) {
        AddChannel(i, record, schemas);
      } else if (opcode == kMessage) {
        const auto channel = channels_[i].find(record.Number(2));
        if (channel != channels_[i].end()) ++topics_[channel->second].messages;
      }
    });
    if (!whole) {
      remarks_.push_back(
          fmt::format("{}: ends in the midst of a record or without an end of data: "
                      "what is whole is read",
                      files_[i].string()));
    }
  }

  // Channels stand in the chunks and again in the summary.
  void AddChannel(std::size_t i, RecordReader& record, const Schemas& schemas) {
    const std::uint64_t id = record.Number(2);
    if (channels_[i].contains(id)) return;
    const auto schema = schemas.find(record.Number(2));
    const std::string name = record.Text(), encoding = record.Text();
    if (encoding != "cdr" && encoding != "ros1") {
      remarks_.push_back(fmt::format("{}: {} is left out: found the encoding {}, expected cdr",
                                     files_[i].string(), name, Quoted(encoding)));
      return;
    }
    const WireFormat format = encoding == "cdr" ? WireFormat::kCdr : WireFormat::kRos1;
    std::size_t topic = 0;
    while (topic < topics_.size() && topics_[topic].name != name) ++topic;
    if (topic == topics_.size()) {
      topics_.push_back({name, schema == schemas.end() ? "" : schema->second, format, 0});
    }
    channels_[i][id] = topic;
  }

  std::vector<fs::path> files_;
  std::vector<BagTopic> topics_;
  std::vector<std::map<std::uint64_t, std::size_t>> channels_;  ///< of each file: id -> topic
};

}  // namespace

std::unique_ptr<Bag> OpenMcap(const std::vector<fs::path>& files) {
  return std::make_unique<McapBag>(files);
}

}  // namespace flextip::exchange
