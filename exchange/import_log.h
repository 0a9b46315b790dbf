// What an import had to assume, and what it has to say besides.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "core/error.h"

namespace flextip::exchange {

/// Something that neither the file nor the user said: its key in a mapping file
/// ("em0.units.length"), and the value taken with the reason.
using Assumptions = std::map<std::string, std::string>;

struct ImportLog {
  Assumptions assumed;
  std::vector<std::string> warnings;  ///< one line each: skipped rows, columns without use

  void Assume(const std::string& key, const std::string& what) { assumed[key] = what; }
  void Warn(const std::string& what) { warnings.push_back(what); }
};

/// Needed, and neither in the file nor told. `keys` are those of a mapping file, so that a program
/// can name its options for them.
class NotTold : public InputError {
 public:
  NotTold(const std::string& what, std::vector<std::string> keys)
      : InputError(what), keys_(std::move(keys)) {}
  const std::vector<std::string>& keys() const { return keys_; }

 private:
  std::vector<std::string> keys_;
};

}  // namespace flextip::exchange
