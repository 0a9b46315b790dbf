// Which columns of a table are a stream's orientation.
#pragma once

#include <string>

#include "exchange/import_plan.h"
#include "exchange/tables/delimited_table.h"
#include "exchange/tables/stream_needs.h"

namespace flextip::exchange {

/// Throws InputError for a `plan.orientation` that is no kind.
void CheckOrientationKind(const std::string& stream, const StreamPlan& plan);

/// Leaves in `roles` the place and the columns of one kind of orientation, and says in
/// `plan.orientation` which. Throws NotTold where the columns may be several things, InputError
/// where those of the kind told are not there.
void ChooseOrientation(const std::string& stream, const DelimitedTable& table, StreamPlan& plan,
                       Roles& roles, ImportLog& log);

}  // namespace flextip::exchange
