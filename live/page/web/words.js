// States, holds and events in plain words.

const HOLDS = {
  none: ["Moving", "good", "The tip follows its path."],
  bad_time: ["Held: bad time", "bad", "The clock stands, or a sample comes from the future."],
  source_lost: ["Held: source lost", "bad", "A source is gone or late."],
  stale_wrist: ["Held: wrist is late", "bad", "The robot does not say where its wrist is."],
  stale_tip: ["Held: tip not seen", "warn", "There is no fresh measurement of the tip."],
  not_enabled: ["Not enabled", "wait", "The robot is not enabled and homed. It does not move."],
  resuming: ["Resuming", "wait", "The cause of the hold is gone. Motion goes on in a moment."],
  starting: ["Starting", "wait", "The tip's place is averaged before the path begins."],
  no_goal: ["Watching", "wait", "The session asks for no motion."],
  no_command: ["Held: no command", "warn", "The controller cannot say where to go."],
  not_finite: ["Held: bad number", "bad", "The controller's command is no number."],
  stopped: ["Stopped", "wait", "The run ends. The robot is being paused."],
  delay_unknown: ["Not enabled: delay unknown", "warn", "The session does not say how late the camera's tip is (latency_s)."],
  tip_jump: ["Held: the tip jumped", "bad", "The tip is not where its last place and the motion since put it."],
  tip_disagrees: ["Held: the tip disagrees", "bad", "The tip and the other sensors cannot be right together."],
  model_disagrees: ["Held: the model disagrees", "bad", "The sensors together do not fit the instrument."],
  wrist_not_following: ["Held: the wrist does not follow", "bad", "The wrist is not where it was commanded to be."],
  port_moved: ["Held: the port has moved", "bad", "The sensors fit a port away from its registered place."],
  port_depth: ["Held: at the port", "warn", "There is too little shaft before or beyond the port."],
  force: ["Held: the tip presses too hard", "warn", "The estimated tip force is above its limit."],
  motion_angle: ["Held: direction uncertain", "warn", "The tip might move too far beside what is wanted."],
  operator: ["Stopped by a person", "wait", "Somebody said stop."],
  speed: ["Held: too fast", "bad", "A speed is above its limit."],
  acceleration: ["Held: acceleration", "bad", "An acceleration is above its limit."],
  jerk: ["Held: jerk", "bad", "A jerk is above its limit."],
  step: ["Held: step", "bad", "A step of the wrist is above its limit."],
  workspace: ["Held: out of the workspace", "bad", "The tip is where it must not be."],
  fixture: ["Held: fixture", "bad", "The tip is in a forbidden region."],
  tip_astray: ["Held: the tip leaves its way", "bad", "The tip is farther from its path than it may be, and gets no nearer."],
  deadline: ["Held: cycle too slow", "bad", "Too many cycles in a row took too long."],
};

const STREAMS = {
  wrist0: "wrist, from the robot", vision0: "tip, seen", em0: "EM sensor at the tip",
  em1: "EM sensor at the port", strain0: "strain in the shaft", load0: "force on the tip",
  robot: "robot's state",
};

export const streamWords = (name) => STREAMS[name] || name;

export function robotWords(robot) {
  if (!robot) return "state not known";
  const parts = [{ DISABLED: "disabled", ENABLED: "enabled", PAUSED: "paused", FAULT: "FAULT" }[robot.state]];
  if (robot.busy) parts.push("busy");
  else parts.push(robot.homed ? "homed" : "not homed");
  return parts.join(", ");
}

const CONTROL = {
  bad_input: "A position is no number.", no_tip: "It waits for a measured tip.",
  no_model: "The shaft's model cannot be evaluated.",
  straight_instead: "The bending is not known: the straight shaft is taken.",
};

/// Returns { title, mood, reason } of the run.
export function stateWords(state, connected, seconds_without_news) {
  if (!connected && state && state.end) return ended(state);
  if (!connected)
    return { title: "No connection", mood: "old",
      reason: state ? "The program does not answer. All below is old." : "The program does not answer." };
  if (!state) return { title: "Waiting", mood: "old", reason: "The first cycle has not run yet." };
  if (state.end) return ended(state);
  const silent = Math.max(state.silent_s, seconds_without_news);
  if (silent > 1)
    return { title: "No news", mood: "old", reason: `The cycle was last heard of ${silent.toFixed(0)} s ago. All below is old.` };
  if (state.robot && state.robot.state === "FAULT" && state.hold !== "stopped")
    return { title: "Robot in FAULT", mood: "bad", reason: "Clear the fault at the robot. Nothing here does." };
  let [title, mood, reason] = HOLDS[state.hold] || [state.hold, "warn", ""];
  if (state.hold === "not_enabled" && state.robot) {
    if (state.robot.state === "PAUSED") title = "Paused";
    if (state.robot.busy) [title, reason] = ["Homing", "The robot is busy."];
  }
  if (state.hold === "source_lost" && state.held_by) reason = `Gone or late: ${streamWords(state.held_by)}.`;
  if (state.hold === "none" && state.limited.length) reason += ` Limited: ${state.limited.join(", ")}.`;
  if ((state.hold === "no_command" || state.hold === "none") && CONTROL[state.status]) reason += ` ${CONTROL[state.status]}`;
  return { title, mood, reason };
}

function ended(state) {
  const paused = state.robot && state.robot.state !== "ENABLED";
  return {
    title: state.end === "done" ? "Done" : "Ended",
    mood: paused ? "good" : "bad",
    reason: (state.end === "done" ? "The path was run to its end. " : "The run ended before its path. ") +
      (state.robot ? `The robot is ${robotWords(state.robot)}.` : "The robot's state is not known."),
  };
}

export function eventWords(event) {
  switch (event.kind) {
    case "told": return `The cycle told the robot: ${event.told}`;
    case "person": return `A person at the page: ${event.wish}`;
    case "change": {
      let [title] = HOLDS[event.hold] || [event.hold];
      if (event.held_by) title += ` (${streamWords(event.held_by)})`;
      return `${title}; robot ${robotWords(event.robot)}`;
    }
    default: return event.what;
  }
}

export function refusalWords(answer) {
  if (answer.why === "token") return "Refused: the address lacks the right token.";
  return "Refused: this session cannot do it.";
}
