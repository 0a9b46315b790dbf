#include "live/recorder/cycle_table.h"

#include <fmt/format.h>

#include "live/recorder/cycle_fields.h"

namespace flextip::live {
namespace {

std::vector<std::string> ColumnNames() {
  fields::Names names;
  CycleRecord record;
  fields::VisitRecord(names, record, CycleRecord());
  return names.names;
}

/// Columns that recordings of earlier versions lack.
CsvOptions MayLackLater() {
  CsvOptions options;
  for (const std::string& name : ColumnNames())
    if (name.starts_with(fields::kLaterStream) || name.starts_with(fields::kLaterFindings) ||
        name.starts_with(fields::kLaterCause))
      options.may_lack.push_back(name);
  return options;
}

}  // namespace

struct CycleTableWriter::Table {
  CsvWriter csv{ColumnNames()};
  CycleRecord before;
};

CycleTableWriter::CycleTableWriter() : table_(std::make_unique<Table>()) {}
CycleTableWriter::~CycleTableWriter() = default;

void CycleTableWriter::Add(const CycleRecord& record) {
  CycleRecord row = record;
  fields::Writing writing{table_->csv};
  fields::VisitRecord(writing, row, table_->before);
  table_->csv.EndRow();
  table_->before = record;
}

std::string CycleTableWriter::TakeText() { return table_->csv.TakeText(); }

struct CycleTableReader::Table {
  Table(const std::filesystem::path& file, ReadLog& log)
      : csv(file, ColumnNames(), log, MayLackLater()) {}
  /// Numbers that stand for names must be ones.
  void Check(const CycleOutputs& outputs) const {
    const auto check = [this](const char* column, int found, int count) {
      if (found >= 0 && found < count) return;
      throw csv.Error(fmt::format("{}: found {}, expected 0 to {}", column, found, count - 1));
    };
    check("hold", static_cast<int>(outputs.hold), kHolds);
    check("held_by", outputs.held_by + 1, kGoalPeer + 2);
    if (!outputs.supervision) return;
    check("found stop", static_cast<int>(outputs.supervision->stop), kStops);
    check("found reaction", static_cast<int>(outputs.supervision->reaction), kReactions);
  }
  CsvReader csv;
  CycleRecord before;
};

CycleTableReader::CycleTableReader(const std::filesystem::path& file, ReadLog& log)
    : table_(std::make_unique<Table>(file, log)) {}
CycleTableReader::~CycleTableReader() = default;

std::optional<CycleRecord> CycleTableReader::Next() {
  if (!table_->csv.Next()) return {};
  CycleRecord record;
  fields::Reading reading{table_->csv};
  fields::VisitRecord(reading, record, table_->before);
  table_->Check(record.outputs);
  table_->before = record;
  return record;
}

}  // namespace flextip::live
