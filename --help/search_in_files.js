// Search on pages that are opened as files. A browser starts no worker and fetches no JSON there:
// the worker's script runs in a hidden frame, and the index comes as a script.
if (location.protocol === "file:") {
  const root = document.currentScript.src.replace(/[^/]*$/, "");

  class WorkerInFrame extends EventTarget {
    constructor(url) {
      super();
      const frame = document.createElement("iframe");
      frame.hidden = true;
      document.body.append(frame);
      this.inside = frame.contentWindow;
      this.inside.postMessage = (data) => this.dispatchEvent(new MessageEvent("message", { data }));
      const script = frame.contentDocument.createElement("script");
      script.src = new URL(url, location);
      this.ready = new Promise((resolve) => (script.onload = resolve));
      frame.contentDocument.head.append(script);
    }
    postMessage(data) {
      this.ready.then(() => this.inside.dispatchEvent(new MessageEvent("message", { data })));
    }
  }
  window.Worker = WorkerInFrame;

  window.__search = {
    index: new Promise((resolve) => {
      window.takeSearchIndex = resolve;
      const script = document.createElement("script");
      script.src = root + "search/search_index.js";
      document.head.append(script);
    }),
  };
}
