// The state of a cycle, for excerpts.
#include "core/error.h"
#include "live/loop/cycle.h"

namespace flextip::live {

void Cycle::VisitState(StateText& state) {
  state(phase_);
  state(enabled_once_);
  state(t_ns_);
  state(clear_since_ns_);
  state(average_from_ns_);
  state(sum_p_);
  state(sum_d_);
  state(averaged_);
  state(tip_time_sd_s_);
  state(em0_time_sd_s_);
  state(controller_);
  if (state.IsThere(path_.has_value())) {
    if (!session_.path || averaged_ <= 0) throw InputError("saved state: no path begins so");
    if (state.Reading()) MakePath();
    state(*path_);
  }
  state(tip_t_ns_);
  state(p_goal_);
  state(p_RE_known_);
  state(p_target_);
  state(p_last_);
  state(v_last_m_s_);
  state(moving_);
  state(wrist_waits_);
  state(jerk_);
  state(p_held_);
  state(asked_ns_);
  state(asked_home_);
  state(fault_);
  state(paused_by_fault_);
}

}  // namespace flextip::live
