// One hidden recording, diagnosed, and what was found in its residuals held against the label.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "diagnosis/diagnose.h"
#include "testdata/hidden/forms.h"
#include "testdata/hidden/recording.h"

namespace flextip::bench {

struct DiscoveryCase {
  std::string part;  ///< forms, healthy, named, deleted
  std::string name;  ///< the form or effect; empty: healthy
  std::uint64_t seed = 1;
  hidden::HiddenOptions options;
};

struct DiscoveryRecord {
  DiscoveryCase made;
  std::string verdict, text, error;
  double separation = 0.0;  ///< of a form, from all that the catalogue has (rival.h)
  int terms = 0;
  bool unknown = false, channel = false, form = false, variable = false;
  bool alias = false;  ///< deleted: the answer is what the whole catalogue could not tell apart
  double heldout_over_true = 0.0, seconds = 0.0;

  bool IsApart() const;
  /// Of a form: unknown, or a term of the right channel.
  bool IsHonest() const { return unknown || channel; }
};

DiscoveryRecord RunDiscovery(const DiscoveryCase& one);

}  // namespace flextip::bench
