// The windows of plays: what is not linear in the search's parameters.
#pragma once

#include <Eigen/Dense>
#include <vector>

#include "arms/effects/play.h"
#include "arms/replay/replay.h"
#include "arms/search/noise.h"

namespace flextip::arms {

/// Sets, reads and looks for the windows of the layout's play. Where the layout has no such effect
/// nothing happens. The references must outlive the object.
class WindowSearch {
 public:
  WindowSearch(Replay& replay, Layout& layout) : replay_(replay), layout_(layout) {}

  bool IsThere() const { return layout_.WindowBlock() >= 0; }
  void Set(const PlayHistory& history);
  PlayHistory History() const;

  /// Gives each joint the window whose state explains most of what is left, joint by joint.
  void Scan(const Noise& noise);
  /// Lets each joint have a window of its own, through which nothing else is dragged.
  void LetGo();
  /// Lets joints drag each other through their plays as the parameters say.
  /// Returns false where none does.
  bool Carry();

 private:
  bool Moves(int joint) const;
  double Range(int joint) const;
  double Explained(const Eigen::VectorXd& at, const std::vector<int>& columns, const Noise& noise);

  Replay& replay_;
  Layout& layout_;
};

}  // namespace flextip::arms
