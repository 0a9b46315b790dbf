#include <string>

#include "exchange/import_plan.h"
#include "exchange/mapping_file.h"
#include "exchange/tables/stream_table.h"
#include "tests/fuzz/files/input_folder.h"
#include "tests/fuzz/files/inputs.h"

namespace flextip {

int CheckImportInput(std::span<const std::uint8_t> input) {
  static const InputFolder folder;
  const auto parts = PartsOf(input);
  if (parts.size() < 2) {
    const auto file = folder.Write("import.yaml", parts[0]);
    exchange::ImportPlan plan;
    if (!ReadsOrRefuses([&] { exchange::ReadMapping(file, plan); })) return 0;
    exchange::ImportPlan again;
    exchange::ReadMapping(folder.Write("again.yaml", exchange::MappingText(plan)), again);
    return 1;
  }
  for (const char* stream : {"wrist0", "em0", "strain0", "load0", "vision0"}) {
    if (parts[0] != std::string(stream) + "\n") continue;
    exchange::StreamPlan plan;
    plan.file = folder.Write("table.csv", parts[1]);
    exchange::ImportLog log;
    exchange::StreamRows rows;
    if (!ReadsOrRefuses([&] { rows = exchange::ReadStreamRows(stream, plan, log); })) return 0;
    for (const auto& [role, values] : rows.values) Require(values.size() == rows.t_ns.size());
    return 1;
  }
  return 0;
}

}  // namespace flextip
