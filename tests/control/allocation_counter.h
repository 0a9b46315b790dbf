// Counts every allocation of the test program, to show that a control step makes none.
#pragma once

namespace flextip {

long AllocationCount();
/// Returns whether allocations are counted. Under the address sanitizer they are not: the count
/// stays 0, and comparing it shows nothing.
bool CountsAllocations();

}  // namespace flextip
