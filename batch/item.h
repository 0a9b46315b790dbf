// What a batch is made of: items, how each ended, and both as a line of text.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace flextip::batch {

struct Item {
  std::string name;                    ///< one of a kind within its batch
  std::vector<std::string> arguments;  ///< the item's own: whatever the work makes of them
  double size = 0.0;                   ///< larger ones are begun first; 0: not known
};

enum class Status : std::uint8_t { kOk, kFailed, kCrashed, kTimedOut };

struct Outcome {
  std::string name;  ///< the item's
  Status status = Status::kOk;
  int exit_code = 0;     ///< -1 where a signal ended the item
  int signal = 0;        ///< 0 where none ended the item
  double seconds = 0.0;  ///< from the fork to the end
  std::string host;      ///< the machine's name
  std::string payload;   ///< what the work left to tell
};

/// Returns "ok", "failed", "crashed SIGSEGV" or "timed out".
std::string StatusText(const Outcome& outcome);

// Lines without a line break, whatever the texts hold: fields between tabs, with "\t", "\n" and
// "\\" for what would be mistaken. Of a line that is none, UnpackItem and UnpackOutcome throw
// InputError.
std::string Pack(const Item& item);
std::string Pack(const Outcome& outcome);
Item UnpackItem(std::string_view line);
Outcome UnpackOutcome(std::string_view line);

}  // namespace flextip::batch
