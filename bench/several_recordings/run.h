// One series of recordings of an instrument, diagnosed together, beside its label.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace flextip::bench {

struct SeveralCase {
  std::string part;  ///< pairs, changes, healthy or predict
  int index = 0;     ///< within the part
  double duration_s = 20.0;
  std::uint64_t first_seed = 1;

  std::string Key() const;
};

struct SeveralRecord {
  std::string key, part, error;
  std::string effect, size;
  std::uint64_t seed = 0;
  bool load = true;
  int begin = 0;           ///< recording in which the effect begins; 0: it is in all
  bool qualifies = false;  ///< the question can be answered, and needs several recordings
  double separation_of_one = 0.0, separation_of_all = 0.0;
  std::string rival;  ///< of the one recording
  std::vector<std::string> verdict;
  std::vector<std::string> changes;  ///< "effect@recording"
  std::vector<std::string> alone;    ///< verdict of the one recording by itself
  double ratio = 0.0, ratio_of_own_fit = 0.0;
  double seconds = 0.0;  ///< of the diagnosis of all together

  /// The label's answer: its effect in all or from `begin` on, and nothing else.
  bool IsRight() const;
  int FalseChanges() const;
};

SeveralRecord RunSeveralCase(const SeveralCase& one);

}  // namespace flextip::bench
