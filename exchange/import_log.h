// What an import assumed, what it has to say, and what nobody told it.
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "core/error.h"
#include "exchange/list_text.h"

namespace flextip::exchange {

/// Something that neither the files nor the user said: its key in a mapping file
/// ("em0.units.length"), and the value taken with the reason.
using Assumptions = std::map<std::string, std::string>;

/// Something needed that nothing tells. `keys` are those of a mapping file that could tell it, so
/// that a program can name its options for them.
struct Missing {
  std::string what;
  std::vector<std::string> keys;
};

/// All that is missing, in one line.
class NotTold : public InputError {
 public:
  explicit NotTold(std::vector<Missing> missing)
      : InputError(Joined(missing)), missing_(std::move(missing)) {}
  NotTold(const std::string& what, std::vector<std::string> keys)
      : NotTold(std::vector<Missing>{{what, std::move(keys)}}) {}

  const std::vector<Missing>& missing() const { return missing_; }

 private:
  static std::string Joined(const std::vector<Missing>& missing) {
    std::string text;
    for (const auto& m : missing) AppendItem(text, m.what, "; ");
    return text;
  }

  std::vector<Missing> missing_;
};

struct ImportLog {
  Assumptions assumed;
  std::vector<std::string> warnings;  ///< one line each: rows left out, columns without use
  std::vector<Missing> missing;       ///< collected, so that the user hears of all at once

  void Assume(const std::string& key, const std::string& what) { assumed[key] = what; }
  void Warn(const std::string& what) { warnings.push_back(what); }

  /// Calls `step`; what it was not told is collected in `missing`.
  template <class Step>
  void Try(Step step) {
    try {
      step();
    } catch (const NotTold& error) {
      missing.insert(missing.end(), error.missing().begin(), error.missing().end());
    }
  }
  /// Throws NotTold where something is missing.
  void RefuseMissing() const {
    if (!missing.empty()) throw NotTold(missing);
  }
};

}  // namespace flextip::exchange
