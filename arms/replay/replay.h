// All recordings of a set predicted with given parameters: what stays of each measurement, and how
// the parameters move it.
#pragma once

#include <Eigen/Dense>
#include <string>
#include <vector>

#include "arms/data/effort_slopes.h"
#include "arms/replay/layout.h"

namespace flextip::arms {

enum class Kind : std::uint8_t { kFollowed, kSeen, kPose, kTorque };
/// "joints0", "joints_seen0", "pose0", "torque0".
const char* Name(Kind kind);

/// Residuals of one sensor in one recording, and their derivatives.
struct Channel {
  int recording = 0;
  Kind kind = Kind::kSeen;
  std::vector<std::string> components;  ///< "q1_rad", "x_m" ...
  Eigen::VectorXd t_s;
  std::vector<Where> where;    ///< on the joints' time line (kFollowed: on its own rows)
  Eigen::VectorXd stated;      ///< noise of each component
  Eigen::MatrixXd residual;    ///< rows x components: measured less predicted; NaN: not measured
  Eigen::MatrixXd derivative;  ///< (rows * components, row by row) x parameters, of the prediction

  Eigen::Index Rows() const { return residual.rows(); }
  Eigen::Index Components() const { return residual.cols(); }
};

/// Where an outside tracker and its marker are before any parameter moves them.
struct Registered {
  Pose T_TR;  ///< takes R to the tracker's frame
  Pose T_LK;
};

class Replay {
 public:
  explicit Replay(const Layout& layout);

  /// Evaluates all channels. `with_derivatives` off leaves the derivatives as they were.
  void Evaluate(const Eigen::VectorXd& theta, bool with_derivatives = true);
  const Eigen::VectorXd& Theta() const { return theta_; }
  const std::vector<Channel>& Channels() const { return channels_; }
  const Layout& GetLayout() const { return layout_; }
  /// True joints as predicted at the rows of recording `r`.
  const Eigen::MatrixXd& Joints(int r) const { return joints_[r]; }

  /// Finds tracker and marker from the poses where they are unknown, for the joints as they are.
  void Register();

 private:
  struct Stage {
    Eigen::MatrixXd output;
    std::vector<JointStage::Column> columns;
  };
  Eigen::MatrixXd CommandOutput(int r, const Eigen::VectorXd& theta) const;
  Stage JointOutput(int r, const Track& input, const Eigen::VectorXd& theta,
                    bool with_derivatives) const;
  std::vector<Eigen::MatrixXd> CommandDerivatives(int r, std::vector<int>& parameters) const;
  void FillJoints(Channel& channel, const Measured& measured, const Eigen::MatrixXd& output,
                  const std::vector<JointStage::Column>& columns) const;
  void FillPose(Channel& channel, const std::vector<JointStage::Column>& columns) const;
  void FillTorque(Channel& channel, const std::vector<JointStage::Column>& columns) const;
  void AddEffortSlopes(Channel& channel, const std::vector<JointStage::Column>& columns,
                       Eigen::MatrixXd& predicted) const;
  PoseStage ActOnPose(int r) const;
  void EvaluateRecording(int r, bool with_derivatives);
  Channel* Find(int r, Kind kind);
  template <class Act>
  void EachEffect(int r, Act act) const {
    for (const Layout::Block& block : layout_.Blocks())
      if (block.in[r]) act(block);
  }

  const Layout& layout_;
  Eigen::VectorXd theta_;
  std::vector<Channel> channels_;
  std::vector<Registered> registered_;
  std::vector<Eigen::MatrixXd> joints_;
  std::vector<EffortStage> efforts_;          ///< shapes, a recording each
  std::vector<Eigen::MatrixXd> base_effort_;  ///< of stated masses
  std::vector<EffortSlopes> effort_slopes_;   ///< of them where joints or links are moved
  bool derivatives_ = true;
};

}  // namespace flextip::arms
