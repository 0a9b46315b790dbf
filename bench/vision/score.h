// What a tracker said of a hard sequence beside the truth, and the figures of many.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace flextip::bench {

/// One frame. Errors mean something where the tip is not lost.
struct FrameScore {
  std::string status;  ///< ok, predicted or lost
  bool in_event = false;
  bool in_view = false;  ///< a tag faces the camera by less than 70 degrees, wholly in the picture
  double error_mm = 0, turn_deg = 0;  ///< errors of the tip and of its frame's rotation (ok alone)
  double nees = 0;                    ///< normalised squared error of the position, 3 in the mean
  double ms = 0;

  /// An ok that its own covariance denies.
  bool IsFalseOk() const { return status == "ok" && nees > 25 && error_mm > 0.5; }
  /// An ok that is wrong, whatever the covariance says.
  bool IsWrongOk() const { return status == "ok" && (error_mm > 1.0 || turn_deg > 2.0); }
  /// An ok on the wrong branch of the planar ambiguity, or of the collar's symmetry.
  bool IsFlip() const { return status == "ok" && turn_deg > 10.0; }
};

struct SequenceScore {
  int number = 0;
  std::vector<std::string> events;
  std::string family;
  double tag_px = 0, speed_m_s = 0;
  bool wrist = false, gamma_known = true;
  std::vector<FrameScore> frames;
};

std::string JsonLine(const SequenceScore& score);

/// All sequences of a file; none where it is missing. A last line that was cut off is left out.
/// Throws InputError for any other line that is none.
std::vector<SequenceScore> ReadScores(const std::filesystem::path& file);

/// By event, frames within it, and all others together; then all.
std::string ScoreTable(const std::vector<SequenceScore>& scores);
std::string ScoreJson(const std::vector<SequenceScore>& scores);

/// Every frame that is a false or a wrong ok, one a line.
std::string WrongFrames(const std::vector<SequenceScore>& scores);

}  // namespace flextip::bench
