// The rows of a table that belong to one stream, in SI units and by their roles.
#pragma once

#include <string>

#include "exchange/import_log.h"
#include "exchange/import_plan.h"
#include "exchange/streams/rows.h"
#include "exchange/tables/delimited_table.h"

namespace flextip::exchange {

/// Opens the stream's table in its dialect.
DelimitedTable OpenTable(const StreamPlan& plan);

/// Reads the rows of `stream` ("em0"; "cam0": times alone), and completes `plan`: columns, units,
/// kind of orientation. Throws InputError with file and line, and NotTold.
StreamRows ReadStreamRows(const std::string& stream, StreamPlan& plan, ImportLog& log);

}  // namespace flextip::exchange
