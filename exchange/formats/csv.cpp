// Tables of other programs as streams.
#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "exchange/formats/formats.h"
#include "exchange/list_text.h"
#include "exchange/streams/names.h"
#include "exchange/streams/series.h"
#include "exchange/tables/column_choice.h"
#include "exchange/tables/stream_table.h"

namespace flextip::exchange {
namespace {

namespace fs = std::filesystem;

void FindTable(const fs::path& file, ImportPlan& plan, ImportLog& log) {
  StreamPlan unknown;
  unknown.file = file;
  const auto names = StreamsIn(OpenTable(unknown), StreamNamed(file.stem().string()));
  if (names.empty()) {
    throw NotTold(fmt::format("{}: neither name nor columns say which sensor it is, expected {}",
                              file.string(), TableStreamsText()),
                  {"streams"});
  }
  for (const auto& name : names) {
    StreamPlan& stream = plan.streams[name];
    if (!stream.file.empty() || !stream.topic.empty()) {
      throw NotTold(fmt::format("{}: looks like {}, which is {} already", file.string(), name,
                                stream.file.empty() ? stream.topic : stream.file.string()),
                    {"streams"});
    }
    stream.file = file;
    log.Assume(name + ".file",
               fmt::format("{}, by the names of file and columns", file.filename().string()));
  }
}

// Columns that no stream of their file uses.
void SayUnused(const ImportPlan& plan, ImportLog& log) {
  std::set<fs::path> seen;
  for (const auto& [name, stream] : plan.streams) {
    if (stream.file.empty() || !seen.insert(stream.file).second) continue;
    std::set<std::string> used;
    for (const auto& [other, of_file] : plan.streams) {
      if (of_file.file != stream.file) continue;
      for (const auto& [role, column] : of_file.columns) used.insert(column);
    }
    const std::vector<std::string> columns = OpenTable(stream).Columns();
    std::string unused;
    for (std::size_t i = 0; i < columns.size(); ++i) {
      if (used.contains(columns[i]) || used.contains(std::to_string(i + 1))) continue;
      AppendItem(unused, columns[i]);
    }
    if (!unused.empty()) log.Warn(fmt::format("{}: not used: {}", stream.file.string(), unused));
  }
}

}  // namespace

void FindTables(ImportPlan& plan, ImportLog& log) {
  for (const fs::path& file : plan.tables) {
    log.Try([&] { FindTable(file, plan, log); });
  }
  plan.tables.clear();
}

void ReadTables(ImportPlan& plan, Streams& streams, ImportLog& log) {
  for (auto& [name, stream] : plan.streams) {
    if (stream.file.empty()) {
      if (!stream.topic.empty()) continue;
      log.missing.push_back({fmt::format("{}: no file is told for it", name), {"streams"}});
      continue;
    }
    log.Try([&, &name = name, &stream = stream] {
      const StreamRows rows = ReadStreamRows(name, stream, log);
      streams.skipped[name] = rows.missing + rows.repeated;
      AddStream(name, rows, stream, streams.recording, log);
      stream.file = fs::absolute(stream.file).lexically_normal();
    });
  }
  if (log.missing.empty()) SayUnused(plan, log);
}

}  // namespace flextip::exchange
