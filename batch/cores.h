// Cores of this machine and their share for an item.
#pragma once

namespace flextip::batch {

/// Returns how many cores this process may use.
int CoresOfThisProcess();

/// Returns the threads of one item where `jobs` run at a time in each of the ranks on this machine:
/// its share of the cores that this process may use, one at least.
int ThreadsOfAnItem(int jobs);

}  // namespace flextip::batch
