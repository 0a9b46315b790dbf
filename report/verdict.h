// The head of a page: the answer, how good it is and why, the next step.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace flextip::report {

/// All as plain text; what is empty is left out.
struct Head {
  std::string grade = {};                 ///< "good", "beware" or "not found"
  std::string says = {};                  ///< the answer in a sentence
  std::vector<std::string> causes = {};   ///< the answer's items, a line each
  std::string more = {};                  ///< the next facts in importance
  std::string advice = {};                ///< what would make the answer more certain
  std::vector<std::string> reasons = {};  ///< to be careful, and to know
  std::string next = {};                  ///< the next step, without a full stop
  std::string command = {};               ///< and as a command to copy
};

/// Returns the head as a section with the grade as a word before the answer.
std::string HeadHtml(const Head& head);

/// Returns FOLDER/summary.json's `verdict`: {grade, says, reasons, next, command}. All empty where
/// the summary has none. Throws InputError where the file cannot be read.
Head VerdictOf(const std::filesystem::path& folder);

}  // namespace flextip::report
