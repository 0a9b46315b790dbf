// The three buttons. Pause and stop act at once; enabling moves the robot, so it is asked twice.
import { refusalWords } from "./words.js";

const SURE_MS = 4000;
const DONE = { enable: "The robot is being enabled.", pause: "The robot is being paused.",
  stop: "The run ends, the robot is being paused." };

export class Controls {
  constructor(token, send) {
    this.token = token;
    this.send = send;
    this.session = null;
    this.sureUntil = 0;
    this.buttons = Object.fromEntries(["enable", "pause", "stop"].map((id) => [id, document.getElementById(id)]));
    this.note = document.getElementById("answer");
    this.buttons.enable.addEventListener("click", () => this.enable());
    this.buttons.pause.addEventListener("click", () => this.wish("pause"));
    this.buttons.stop.addEventListener("click", () => this.wish("stop"));
    document.addEventListener("keydown", (event) => {
      if (event.key === "Escape" && !this.buttons.pause.disabled) this.wish("pause");
    });
  }

  begin(session) {
    this.session = session;
    if (!this.token) this.say("Watching only: the command printed an address that may command.");
    else if (!session.can_command) this.say("This session does not enable or pause the robot.");
    else this.say("Esc pauses.");
  }

  update(state, connected) {
    const may = this.token !== "" && connected && this.session !== null && state && !state.end;
    const can = may && this.session.can_command;
    const robot = state && state.robot;
    const ready = robot && robot.state === "ENABLED" && robot.homed;
    const fault = robot && robot.state === "FAULT";
    this.buttons.enable.disabled = !(can && this.session.says_state && !ready && !fault && !state.stop);
    this.buttons.pause.disabled = !can;
    this.buttons.stop.disabled = !(may && !state.stop);
    const sure = performance.now() < this.sureUntil && !this.buttons.enable.disabled;
    this.buttons.enable.classList.toggle("sure", sure);
    this.buttons.enable.textContent = sure ? "Yes, enable" : "Enable";
  }

  enable() {
    if (performance.now() < this.sureUntil) {
      this.sureUntil = 0;
      this.wish("enable");
      return;
    }
    this.sureUntil = performance.now() + SURE_MS;
    this.say("The instrument may move. Press again to enable.");
  }

  wish(what) {
    if (!this.send(what, this.token)) this.say("Not sent: no connection.");
  }

  answer(message) { this.say(message.accepted ? DONE[message.do] : refusalWords(message)); }
  say(text) { this.note.textContent = text; }
}
