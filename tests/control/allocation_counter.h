// Counts every allocation of the test program, to show that a control step makes none.
#pragma once

namespace flextip {

long AllocationCount();

}  // namespace flextip
