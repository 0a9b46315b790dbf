// Corners and views that do not belong: found against the noise of all the others.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "calibration/camera/solution.h"

namespace flextip {

/// A view that is not used, by its place among all views given.
struct RejectedView {
  std::size_t index = 0;
  std::string reason;
};

struct OutlierRule {
  /// A corner is an outlier where it is off by more than this many times the noise of the corners
  /// used (per coordinate), which is estimated anew in each round.
  double corner_ratio = 4.0;
  /// A view is rejected where its median distance is more than this many times that of all.
  double view_ratio = 4.0;
  /// A view is also rejected where more than this share of its corners are outliers.
  double view_share = 0.5;
  int min_views = 3;
  bool estimate_warp = false;
};

/// Adjusts robustly, rejects, and adjusts by least squares over the rest until nothing changes;
/// outliers may come back. Takes rejected views out of `solution.views` and lists them in
/// `rejected`; keeps at least `min_views`. Returns false where an adjustment fails.
bool RejectOutliers(CameraSolution& solution, const OutlierRule& rule,
                    std::vector<RejectedView>& rejected);

}  // namespace flextip
