// The rows of a table that belong to one stream, in SI units and by their roles.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "core/time_series.h"
#include "exchange/import_log.h"
#include "exchange/import_plan.h"
#include "exchange/tables/delimited_table.h"

namespace flextip::exchange {

struct StreamRows {
  std::vector<TimeNs> t_ns;
  std::vector<long> lines;                            ///< of each row, for messages
  std::map<std::string, std::vector<double>> values;  ///< role -> a number a row
  long duplicates = 0;                                ///< rows equal to the one before, left out
  long missing = 0;                                   ///< rows with missing values, left out
};

/// What the words of a name say of the stream it belongs to; empty where they say nothing.
std::string StreamNamed(const std::string& name);

/// Opens the stream's table in its dialect.
DelimitedTable OpenTable(const StreamPlan& plan);

/// Reads the rows of stream `name` ("em0"; "cam0": times alone), and completes `plan`: columns,
/// units, kind of orientation. Throws InputError with file and line, and NotTold.
StreamRows ReadStreamRows(const std::string& name, StreamPlan& plan, ImportLog& log);

}  // namespace flextip::exchange
