// A small recording with every stream, and a folder for it that goes away with the test.
#pragma once

#include <filesystem>
#include <string>

#include "core/error.h"
#include "recording/recording.h"
#include "recording/truth.h"

namespace flextip::test_support {

class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }

 private:
  std::filesystem::path path_;
};

inline constexpr int kSamples = 6;  ///< rows in every stream: lines 2 to 7
inline constexpr int kWidth = 32, kHeight = 24;

/// Every stream with awkward numbers: all 17 digits in use, subnormal, large, negative
/// zero.
Recording MakeRecording();
Series<TruthSample> MakeTruth();

/// Writes MakeRecording(), MakeTruth() and a PNG for each frame of cam0 and cam1.
void WriteSample(const std::filesystem::path& folder);

std::string ReadText(const std::filesystem::path& file);
void WriteText(const std::filesystem::path& file, const std::string& text);

/// Returns the message with which `work` is refused; "not refused" where it is not.
template <class Work>
std::string Refusal(const Work& work) {
  try {
    work();
  } catch (const InputError& error) {
    return error.what();
  } catch (const WorkError& error) {
    return error.what();
  }
  return "not refused";
}

/// Replaces line `line` (from 1) of a text file.
void ReplaceLine(const std::filesystem::path& file, int line, const std::string& text);
std::string Line(const std::filesystem::path& file, int line);

/// Replaces `from`, which must be in the file, by `to`; the number of the line it was in.
int Replace(const std::filesystem::path& file, const std::string& from, const std::string& to);

}  // namespace flextip::test_support
