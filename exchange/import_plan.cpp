#include "exchange/import_plan.h"

namespace flextip::exchange {

void ImportPlan::Told(const std::string& key) {
  std::erase_if(assumed, [&](const auto& entry) {
    return entry.first == key || entry.first.starts_with(key + ".");
  });
}

}  // namespace flextip::exchange
