// Writes MCAP files: time-stamped messages on channels with schemas, in chunks with an index.
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "core/time_series.h"

namespace flextip::exports {

/// A writer of MCAP version 0 without compression (mcap.dev/spec): messages are JSON, schemas are
/// JSON schemas. Messages should come in the order of their times.
class McapWriter {
 public:
  /// Begins the file. Throws WorkError where the disk refuses.
  explicit McapWriter(const std::filesystem::path& file);

  /// Adds a channel; a schema's name is written once, with the text of its first use. Returns the
  /// channel's number.
  std::uint16_t AddChannel(const std::string& topic, const std::string& schema_name,
                           const std::string& json_schema);
  /// Adds a message (JSON text) on a channel. Times must not be negative.
  void Add(std::uint16_t channel, TimeNs t_ns, const std::string& json);
  /// Writes the index and the end. Throws WorkError where the disk refuses.
  void Finish();

  std::uint64_t Messages() const { return messages_; }

 private:
  struct ChunkIndex {
    std::uint64_t first_ns = 0, last_ns = 0, start = 0, length = 0, index_length = 0, size = 0;
    std::map<std::uint16_t, std::uint64_t> index_at;
  };
  void Write(const std::string& bytes);
  void EndChunk();

  std::filesystem::path path_;
  std::ofstream file_;
  std::uint64_t written_ = 0, messages_ = 0, first_ns_ = 0, last_ns_ = 0;
  std::vector<std::string> schemas_, channels_;  // their records
  std::map<std::string, std::uint16_t> schema_ids_;
  std::map<std::uint16_t, std::uint64_t> count_;  // messages of each channel
  std::string chunk_;                             // records of the present chunk
  std::uint64_t chunk_first_ns_ = 0, chunk_last_ns_ = 0;
  std::map<std::uint16_t, std::vector<std::pair<std::uint64_t, std::uint64_t>>> chunk_index_;
  std::vector<ChunkIndex> chunks_;
};

}  // namespace flextip::exports
