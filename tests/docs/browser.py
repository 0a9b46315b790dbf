"""A headless browser that looks at local pages: a page of checks runs beside them and reports."""
import functools
import http.server
import json
import os
import pathlib
import shutil
import subprocess
import tempfile
import threading

SKIPPED = 77  # what ctest takes as skipped
# What every page of checks may use. `look` opens a page in a frame of a width and waits for it.
COMMON = """
const wait = (ms) => new Promise((done) => setTimeout(done, ms));
async function until(condition, seconds) {
  for (let i = 0; i < seconds * 20; ++i) { if (condition()) return true; await wait(50); }
  return false;
}
const frame = document.createElement("iframe");
document.body.append(frame);
async function look(url, width) {
  frame.style.width = width + "px";
  frame.style.height = "900px";
  frame.style.border = "0";
  const loaded = new Promise((done) => (frame.onload = done));
  frame.src = url;
  await loaded;
  return frame.contentDocument;
}
async function report(result) {
  await fetch("/__result__", { method: "POST", body: JSON.stringify(result) });
}
"""


def chromium():
    """Returns the command of the browser; None where there is none."""
    return shutil.which("chromium") or shutil.which("chromium-browser")


def command(profile, *arguments):
    sandbox = ["--no-sandbox"] if os.geteuid() == 0 else []
    return [chromium(), "--headless", "--disable-gpu", "--no-first-run", "--disable-extensions",
            "--disable-background-networking", "--disable-dev-shm-usage", "--window-size=1300,1000",
            f"--user-data-dir={profile}", *sandbox, *arguments]


class Handler(http.server.SimpleHTTPRequestHandler):
    """Serves a folder, a page of checks, and takes what that reports."""

    def log_message(self, *_):
        pass

    def do_GET(self):
        if self.path != "/__checks__":
            super().do_GET()
            return
        page = f'<!DOCTYPE html><meta charset="utf-8"><body style="margin:0"><script>{COMMON}'
        page += f"(async () => {{ try {{ await report(await (async () => {{ {self.server.script} }})()); }}"
        page += " catch (error) { await report({ error: String(error) }); } })();</script></body>"
        body = page.encode()
        self.send_response(200)
        self.send_header("Content-Type", "text/html; charset=utf-8")
        self.send_header("Content-Length", str(len(body)))
        self.end_headers()
        self.wfile.write(body)

    def do_POST(self):
        text = self.rfile.read(int(self.headers["Content-Length"]))
        self.send_response(204)
        self.end_headers()
        self.server.result = json.loads(text)
        self.server.arrived.set()


def run_checks(folder, script, seconds):
    """Serves `folder` on this machine alone and runs the body of an async function beside its pages.

    Returns what the function returned, or {"error": text}.
    """
    handler = functools.partial(Handler, directory=str(folder))
    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), handler)
    server.script, server.result, server.arrived = script, None, threading.Event()
    threading.Thread(target=server.serve_forever, daemon=True).start()
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as profile:
        address = f"http://127.0.0.1:{server.server_port}/__checks__"
        browser = subprocess.Popen(command(profile, "--remote-debugging-port=0", address),
                                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        try:
            server.arrived.wait(seconds)
        finally:
            browser.terminate()
            try:
                browser.wait(10)
            except subprocess.TimeoutExpired:
                browser.kill()
                browser.wait()
            server.shutdown()
    return server.result or {"error": f"the browser reported nothing within {seconds} s"}


def dom_of_file(path, query, seconds):
    """Returns the document of a page opened as a file, after its scripts have run."""
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as profile:
        url = pathlib.Path(path).resolve().as_uri() + query
        done = subprocess.run(
            command(profile, f"--virtual-time-budget={1000 * seconds}", "--dump-dom", url),
            capture_output=True, encoding="utf-8", errors="replace", timeout=6 * seconds,
            check=False)
    return done.stdout
