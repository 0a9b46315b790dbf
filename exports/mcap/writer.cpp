#include "exports/mcap/writer.h"

#include <algorithm>
#include <array>

#include "core/check.h"
#include "core/error.h"

namespace flextip::exports {
namespace {

// Opcodes of the records, mcap.dev/spec.
enum Opcode : std::uint8_t {
  kHeader = 0x01,
  kFooter = 0x02,
  kSchema = 0x03,
  kChannel = 0x04,
  kMessage = 0x05,
  kChunk = 0x06,
  kMessageIndex = 0x07,
  kChunkIndex = 0x08,
  kStatistics = 0x0B,
  kSummaryOffset = 0x0E,
  kDataEnd = 0x0F,
};

constexpr char kMagic[] = "\x89MCAP0\r\n";
constexpr std::size_t kChunkBytes = 1 << 20;

/// Appends numbers in little-endian order.
template <class T>
void Put(std::string& to, T value) {
  for (std::size_t i = 0; i < sizeof value; ++i) {
    to += static_cast<char>(static_cast<std::uint64_t>(value) >> (8 * i) & 0xff);
  }
}

void PutText(std::string& to, const std::string& text) {
  Put(to, static_cast<std::uint32_t>(text.size()));
  to += text;
}

std::string Record(Opcode opcode, const std::string& content) {
  std::string record(1, static_cast<char>(opcode));
  Put(record, static_cast<std::uint64_t>(content.size()));
  return record + content;
}

/// The CRC-32 of IEEE 802.3.
std::uint32_t Crc32(const std::string& bytes, std::uint32_t crc = 0) {
  static const auto table = [] {
    std::array<std::uint32_t, 256> t;
    for (std::uint32_t i = 0; i < 256; ++i) {
      std::uint32_t c = i;
      for (int k = 0; k < 8; ++k) c = c & 1 ? 0xedb88320u ^ c >> 1 : c >> 1;
      t[i] = c;
    }
    return t;
  }();
  crc = ~crc;
  for (const char b : bytes) crc = table[(crc ^ static_cast<std::uint8_t>(b)) & 0xff] ^ crc >> 8;
  return ~crc;
}

}  // namespace

McapWriter::McapWriter(const std::filesystem::path& file)
    : path_(file), file_(file, std::ios::binary) {
  Write(std::string(kMagic, 8));
  std::string header;
  PutText(header, "");  // no profile
  PutText(header, "flextip");
  Write(Record(kHeader, header));
}

void McapWriter::Write(const std::string& bytes) {
  file_.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  if (!file_) throw WorkError(path_.string() + ": cannot be written");
  written_ += bytes.size();
}

std::uint16_t McapWriter::AddChannel(const std::string& topic, const std::string& schema_name,
                                     const std::string& json_schema) {
  const auto [at, is_new] =
      schema_ids_.try_emplace(schema_name, static_cast<std::uint16_t>(schema_ids_.size() + 1));
  if (is_new) {
    std::string schema;
    Put(schema, at->second);
    PutText(schema, schema_name);
    PutText(schema, "jsonschema");
    PutText(schema, json_schema);
    schemas_.push_back(Record(kSchema, schema));
    chunk_ += schemas_.back();
  }
  const auto id = static_cast<std::uint16_t>(channels_.size() + 1);
  std::string channel;
  Put(channel, id);
  Put(channel, at->second);
  PutText(channel, topic);
  PutText(channel, "json");
  Put(channel, std::uint32_t{0});  // no metadata
  channels_.push_back(Record(kChannel, channel));
  chunk_ += channels_.back();
  return id;
}

void McapWriter::Add(std::uint16_t channel, TimeNs t_ns, const std::string& json) {
  FLEXTIP_CHECK(channel >= 1 && channel <= channels_.size(), "a channel that was added");
  FLEXTIP_CHECK(t_ns >= 0, "a time that is not negative");
  const auto time = static_cast<std::uint64_t>(t_ns);
  const bool first_of_chunk = chunk_index_.empty();
  chunk_first_ns_ = first_of_chunk ? time : std::min(chunk_first_ns_, time);
  chunk_last_ns_ = first_of_chunk ? time : std::max(chunk_last_ns_, time);
  first_ns_ = messages_ == 0 ? time : std::min(first_ns_, time);
  last_ns_ = messages_ == 0 ? time : std::max(last_ns_, time);
  chunk_index_[channel].emplace_back(time, chunk_.size());
  std::string message;
  Put(message, channel);
  Put(message, static_cast<std::uint32_t>(count_[channel]++));
  Put(message, time);  // logged
  Put(message, time);  // published
  chunk_ += Record(kMessage, message + json);
  ++messages_;
  if (chunk_.size() >= kChunkBytes) EndChunk();
}

void McapWriter::EndChunk() {
  if (chunk_.empty()) return;
  ChunkIndex index{.first_ns = chunk_first_ns_,
                   .last_ns = chunk_last_ns_,
                   .start = written_,
                   .size = chunk_.size(),
                   .index_at = {}};
  std::string chunk;
  Put(chunk, chunk_first_ns_);
  Put(chunk, chunk_last_ns_);
  Put(chunk, static_cast<std::uint64_t>(chunk_.size()));
  Put(chunk, Crc32(chunk_));
  PutText(chunk, "");  // not compressed
  Put(chunk, static_cast<std::uint64_t>(chunk_.size()));
  Write(Record(kChunk, chunk + chunk_));
  index.length = written_ - index.start;
  for (const auto& [channel, entries] : chunk_index_) {
    index.index_at[channel] = written_;
    std::string content;
    Put(content, channel);
    Put(content, static_cast<std::uint32_t>(16 * entries.size()));
    for (const auto& [time, offset] : entries) {
      Put(content, time);
      Put(content, offset);
    }
    Write(Record(kMessageIndex, content));
  }
  index.index_length = written_ - index.start - index.length;
  chunks_.push_back(std::move(index));
  chunk_.clear();
  chunk_index_.clear();
  chunk_first_ns_ = chunk_last_ns_ = 0;
}

void McapWriter::Finish() {
  EndChunk();
  std::string end;
  Put(end, std::uint32_t{0});  // the data's CRC is not given; each chunk has its own
  Write(Record(kDataEnd, end));
  const std::uint64_t summary_start = written_;
  std::string summary;
  std::vector<std::pair<Opcode, std::pair<std::uint64_t, std::uint64_t>>> groups;
  const auto add_group = [&](Opcode opcode, const std::string& records) {
    if (records.empty()) return;
    groups.push_back({opcode, {summary_start + summary.size(), records.size()}});
    summary += records;
  };
  std::string schemas, channels, statistics, indexes;
  for (const auto& record : schemas_) schemas += record;
  for (const auto& record : channels_) channels += record;
  Put(statistics, messages_);
  Put(statistics, static_cast<std::uint16_t>(schemas_.size()));
  Put(statistics, static_cast<std::uint32_t>(channels_.size()));
  Put(statistics, std::uint32_t{0});  // attachments
  Put(statistics, std::uint32_t{0});  // metadata
  Put(statistics, static_cast<std::uint32_t>(chunks_.size()));
  Put(statistics, first_ns_);
  Put(statistics, last_ns_);
  Put(statistics, static_cast<std::uint32_t>(10 * count_.size()));
  for (const auto& [channel, count] : count_) {
    Put(statistics, channel);
    Put(statistics, count);
  }
  for (const ChunkIndex& chunk : chunks_) {
    std::string content;
    for (const std::uint64_t v : {chunk.first_ns, chunk.last_ns, chunk.start, chunk.length}) {
      Put(content, v);
    }
    Put(content, static_cast<std::uint32_t>(10 * chunk.index_at.size()));
    for (const auto& [channel, at] : chunk.index_at) {
      Put(content, channel);
      Put(content, at);
    }
    Put(content, chunk.index_length);
    PutText(content, "");
    Put(content, chunk.size);
    Put(content, chunk.size);
    indexes += Record(kChunkIndex, content);
  }
  add_group(kSchema, schemas);
  add_group(kChannel, channels);
  add_group(kStatistics, Record(kStatistics, statistics));
  add_group(kChunkIndex, indexes);
  const std::uint64_t offsets_start = summary_start + summary.size();
  for (const auto& [opcode, place] : groups) {
    std::string content(1, static_cast<char>(opcode));
    Put(content, place.first);
    Put(content, place.second);
    summary += Record(kSummaryOffset, content);
  }
  // The CRC covers the summary and the footer up to itself.
  std::string footer(1, static_cast<char>(kFooter));
  Put(footer, std::uint64_t{20});
  Put(footer, summary_start);
  Put(footer, offsets_start);
  const std::uint32_t crc = Crc32(summary + footer);
  Put(footer, crc);
  Write(summary + footer);
  Write(std::string(kMagic, 8));
  file_.close();
  if (!file_) throw WorkError(path_.string() + ": cannot be written");
}

}  // namespace flextip::exports
