// The section `discovered` of model.yaml. Private to the extended model.
#pragma once

#include <string>
#include <vector>

#include "diagnosis/effects/discovered/term.h"
#include "recording/text/yaml_map.h"

namespace flextip::diagnosis {

/// Returns the section's lines; empty without terms.
std::string TermsYaml(const std::vector<Term>& terms);

/// Reads the section of `top`. Throws InputError with file and line for a channel, shape or
/// variable that is unknown, a wrong count and parameters that have no meaning.
std::vector<Term> ReadTerms(const YamlMap& top);

}  // namespace flextip::diagnosis
