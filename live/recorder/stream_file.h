// A stream of a recording, written while its samples come.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "live/streams/samples.h"
#include "recording/recording.h"

namespace flextip::live {

/// A file that grows by whole lines. Throws WorkError where the disk refuses.
class LineFile {
 public:
  explicit LineFile(const std::filesystem::path& file);
  ~LineFile();
  LineFile(const LineFile&) = delete;
  LineFile& operator=(const LineFile&) = delete;

  /// Gives the lines to the system, in one call where it takes them.
  void Append(const std::string& lines);

 private:
  std::filesystem::path file_;
  int descriptor_;
};

/// RECORDING/STREAM: there from the first sample on, readable after every Flush.
class StreamFile {
 public:
  /// `base` has the stream's settings, and must outlive this.
  StreamFile(std::filesystem::path recording, StreamName stream, const Recording& base);
  /// command0, which says `comment`.
  StreamFile(std::filesystem::path recording, const std::string& comment, double rate_hz,
             const Recording& base);

  void Add(const Arrived<AnySample>& sample);
  /// Writes the rows since the last call.
  void Flush();
  /// Writes the settings again, with the rate as measured.
  void Finish();

 private:
  void Begin(const std::filesystem::path& recording, const Recording& one) const;
  Recording WithOne(double rate_hz) const;
  const char* Folder() const { return commands_ ? "command0" : Name(stream_); }

  std::filesystem::path recording_;
  StreamName stream_;
  const Recording* base_;
  std::optional<CommandStream> commands_;
  std::optional<Arrived<AnySample>> first_;
  TimeNs last_ns_ = 0;
  long samples_ = 0;
  double squared_noise_ = 0.0;  // of the tip's direction
  std::string rows_;
  std::unique_ptr<LineFile> file_;
};

}  // namespace flextip::live
