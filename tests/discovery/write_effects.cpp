// Writes the effects of source_terms.h into the folder that is named, for effect_source_test.
#include <fstream>

#include "diagnosis/effects/discovered/term_source.h"
#include "tests/discovery/source_terms.h"

int main(int argc, char** argv) {
  using namespace flextip::diagnosis;
  if (argc != 2) return 2;
  for (const auto& [name, term] : SourceTerms()) {
    std::ofstream file(std::string(argv[1]) + "/" + name + ".cpp");
    file << EffectSource(term, name);
    if (!file) return 1;
  }
  return 0;
}
