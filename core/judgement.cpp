#include "core/judgement.h"

namespace flextip {

const char* Name(Grade grade) {
  switch (grade) {
    case Grade::kGood:
      return "good";
    case Grade::kBeware:
      return "beware";
    case Grade::kNotFound:
      break;
  }
  return "not found";
}

void Judgement::Beware(const std::string& reason) {
  if (grade == Grade::kGood) grade = Grade::kBeware;
  reasons.push_back(reason);
}

void Judgement::Mention(const std::string& reason, bool careful) {
  if (careful) {
    Beware(reason);
  } else {
    reasons.push_back(reason);
  }
}

}  // namespace flextip
