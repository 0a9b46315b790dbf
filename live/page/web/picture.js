// The laparoscope's picture and, over it, tags, tip, frame, shaft and goal.
import { colours } from "./canvas.js";

export class Picture {
  constructor(canvas, empty, legend, overlay) {
    Object.assign(this, { canvas, empty, legend, overlay });
    this.busy = false;
  }

  begin(session) {
    if (session.camera) return;
    const from = { vision0: "The tip comes from a tracker (vision0).",
      em0: "The tip comes from an EM sensor (em0)." }[session.tip_from] || "Nothing measures the tip.";
    this.empty.textContent = `This session has no camera. ${from}`;
  }

  async take(message, jpeg) {
    if (this.busy) return;  // a newer one comes
    this.busy = true;
    try {
      const image = await createImageBitmap(jpeg);
      this.draw(message, image);
      image.close();
    } finally {
      this.busy = false;
    }
  }

  draw(message, image) {
    this.canvas.hidden = this.legend.hidden = false;
    this.empty.hidden = true;
    const { canvas } = this;
    if (canvas.width !== image.width || canvas.height !== image.height)
      [canvas.width, canvas.height] = [image.width, image.height];
    canvas.dataset.tNs = message.t_ns;
    canvas.dataset.tags = message.tags.length;
    const ctx = canvas.getContext("2d");
    ctx.drawImage(image, 0, 0);
    if (!this.overlay.checked) return;
    const scale = image.width / message.width;
    const px = (p) => [scale * (p[0] + 0.5), scale * (p[1] + 0.5)];
    const line = (points, colour, width, closed) => {
      ctx.strokeStyle = colour;
      ctx.lineWidth = width;
      ctx.beginPath();
      let pen = false;
      for (const p of points) {
        if (!p) { pen = false; continue; }
        if (pen) ctx.lineTo(...px(p)); else ctx.moveTo(...px(p));
        pen = true;
      }
      if (closed) ctx.closePath();
      ctx.stroke();
    };
    ctx.lineCap = ctx.lineJoin = "round";
    const ink = colours();
    line(message.shaft, ink.shaft, 3);
    for (const tag of message.tags) line(tag.corners, "#3fe0e0", 1.5, true);
    if (message.tip) message.axes.forEach((end, i) => end && line([message.tip, end], ["#ff5a5a", "#5adf5a", "#6aa0ff"][i], 2));
    if (message.goal) this.ring(ctx, px(message.goal), 7, "#35e08a");
    if (message.tip) this.tip(ctx, message, px, scale);
    if (message.status !== "ok") this.say(ctx, message.status === "lost" ? "tip not seen" : "tip not seen, predicted");
  }

  ring(ctx, [x, y], radius, colour) {
    ctx.strokeStyle = colour;
    ctx.lineWidth = 2;
    ctx.beginPath();
    ctx.arc(x, y, radius, 0, 2 * Math.PI);
    ctx.stroke();
  }

  tip(ctx, message, px, scale) {
    const [x, y] = px(message.tip);
    this.ring(ctx, [x, y], 3, "#ff6fae");
    if (!message.doubt) return;
    ctx.strokeStyle = "#ff6fae";
    ctx.lineWidth = 1.5;
    ctx.beginPath();
    ctx.ellipse(x, y, scale * message.doubt[0], scale * message.doubt[1], message.doubt[2], 0, 2 * Math.PI);
    ctx.stroke();
  }

  say(ctx, words) {
    ctx.font = "bold 20px system-ui, sans-serif";
    ctx.textAlign = "left";
    ctx.lineWidth = 4;
    ctx.strokeStyle = "#000";
    ctx.fillStyle = "#ffb050";
    ctx.strokeText(words, 12, 28);
    ctx.fillText(words, 12, 28);
  }
}
