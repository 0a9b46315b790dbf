// Which columns of a table make a stream.
#pragma once

#include <string>

#include "exchange/import_log.h"
#include "exchange/import_plan.h"
#include "exchange/tables/column_roles.h"
#include "exchange/tables/delimited_table.h"

namespace flextip::exchange {

struct ColumnChoice {
  Roles roles;                               ///< of the columns that are read
  std::map<std::string, std::string> units;  ///< role -> unit as the header writes it; may lack
};

/// Chooses the columns of stream `name`: those told, and the others by the table's header or, where
/// there is none, by their number. Completes plan.orientation and plan.columns. Throws NotTold
/// where nothing tells, InputError for a column that is not there.
ColumnChoice ChooseColumns(const std::string& name, const DelimitedTable& table, StreamPlan& plan,
                           ImportLog& log);

/// The streams that a table holds by its columns: their names, in order. `by_file` is the stream
/// that the file's name tells, or empty.
std::vector<std::string> StreamsIn(const DelimitedTable& table, const std::string& by_file);

}  // namespace flextip::exchange
