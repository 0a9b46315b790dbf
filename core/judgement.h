// How good a result is, and why, in a user's words: the head of its page.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace flextip {

enum class Grade : std::uint8_t {
  kGood,
  kBeware,    ///< to be used with care
  kNotFound,  ///< there is no answer, or none that holds
};
/// Returns "good", "beware" or "not found".
const char* Name(Grade grade);

/// Texts stand on pages and terminals as they are: `says` with a full stop, the others without.
struct Judgement {
  Grade grade = Grade::kGood;
  std::string says;                  ///< the answer in a sentence
  std::vector<std::string> reasons;  ///< to be careful, and to know
  std::string next;                  ///< the next step
  std::string command;               ///< and as a command to copy; may be empty

  /// Adds a reason to be careful, which takes a good grade down.
  void Beware(const std::string& reason);
  /// Adds `reason` as one to be careful where `careful`, else as one to know.
  void Mention(const std::string& reason, bool careful);
};

}  // namespace flextip
