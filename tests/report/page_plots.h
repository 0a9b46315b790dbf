// The figures of a page, read back.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace flextip::report {

/// Returns the figures that the page holds, in their order.
inline std::vector<nlohmann::json> PlotsIn(const std::string& html) {
  const std::string begin = "<script type=\"application/json\">";
  std::vector<nlohmann::json> plots;
  for (auto at = html.find(begin); at != std::string::npos; at = html.find(begin, at)) {
    at += begin.size();
    plots.push_back(nlohmann::json::parse(html.substr(at, html.find("</script>", at) - at)));
  }
  return plots;
}

}  // namespace flextip::report
