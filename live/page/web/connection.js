// The connection to the program: texts and pictures in, wishes out. It comes back by itself.

const AGAIN_MS = 1000;

/// Takes the token off the address, so that neither history nor a photograph of the screen has it.
export function takeToken() {
  const given = new URLSearchParams(location.search).get("token");
  if (given) {
    sessionStorage.setItem("flextip-token", given);
    history.replaceState(null, "", location.pathname);
  }
  return sessionStorage.getItem("flextip-token") || "";
}

export class Connection {
  /// `on` has hello(m), state(m), answer(m), picture(m, jpeg) and changed(connected).
  constructor(on) {
    this.on = on;
    this.socket = null;
    this.open();
  }

  get connected() { return this.socket !== null && this.socket.readyState === WebSocket.OPEN; }

  open() {
    const socket = new WebSocket(`ws://${location.host}/live`);
    socket.binaryType = "arraybuffer";
    socket.onopen = () => this.on.changed(true);
    socket.onmessage = (event) => this.take(event.data);
    socket.onclose = () => {
      if (this.socket === socket) this.socket = null;
      this.on.changed(false);
      setTimeout(() => this.open(), AGAIN_MS);
    };
    this.socket = socket;
  }

  take(data) {
    if (typeof data === "string") {
      const message = JSON.parse(data);
      this.on[message.type](message);
      if (message.n) this.seen(message.n);
      return;
    }
    const length = new DataView(data).getUint32(0, true);
    const head = JSON.parse(new TextDecoder().decode(new Uint8Array(data, 4, length)));
    this.on.picture(head, new Blob([new Uint8Array(data, 4 + length)], { type: "image/jpeg" }));
    this.seen(head.n);
  }

  /// The program sends no more than this page says it has seen.
  seen(n) {
    if (this.connected) this.socket.send(`{"seen":${n}}`);
  }

  wish(what, token) {
    if (!this.connected) return false;
    this.socket.send(JSON.stringify({ do: what, token }));
    return true;
  }
}
