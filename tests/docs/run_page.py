#!/usr/bin/env python3
"""Runs the commands of a page of the docs in order, as a reader who copies them does.

    run_page.py --source ROOT --program build/ci/apps/flextip --work FOLDER docs/tour.md

Every block of ```sh runs in FOLDER, which holds a copy of testdata/ and the program at
build/release/apps. A block fails where a command fails, where a file `out/...` that the text after
it names is not there, or where a line of the ```text block after it was not printed.
"""
import argparse
import os
import pathlib
import resource
import shutil
import subprocess
import sys

from markdown_page import steps
from printed import missing

SECONDS_OF_A_BLOCK = 600  # on a machine that does other work


def prepare(work, source, program):
    """Makes the folder that the reader stands in: a copy of the data, nothing of the source."""
    shutil.rmtree(work, ignore_errors=True)
    code = shutil.ignore_patterns("*.cpp", "*.h", "*.txt")
    shutil.copytree(source / "testdata", work / "testdata", ignore=code)
    (work / "build/release").mkdir(parents=True)
    (work / "build/release/apps").symlink_to(program.parent)
    for name in ("home", "tmp"):
        (work / name).mkdir()


def environment(work, page_text):
    """The reader's: no display; the program on PATH but where the page itself puts it there."""
    path = "/usr/local/bin:/usr/bin:/bin"
    if "export PATH" not in page_text:
        path = f"{work}/build/release/apps:{path}"
    return {"HOME": f"{work}/home", "TMPDIR": f"{work}/tmp", "PATH": path, "LC_ALL": "C.UTF-8"}


class Shell:
    """Runs blocks one after the other: each starts with the variables and folder of the last."""

    def __init__(self, work, env):
        self.work, self.env, self.kept = work, env, work / "home/variables"

    def run(self, text):
        """Returns the exit code, what was printed, and the processor seconds."""
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        script = f'[ ! -f "{self.kept}" ] || . "{self.kept}"\nset -e\n{text}\n'
        script += f'{{ export -p; printf "cd %q\\n" "$PWD"; }} >"{self.kept}"\n'
        try:
            done = subprocess.run(
                ["bash", "-c", script], cwd=self.work, env=self.env, timeout=SECONDS_OF_A_BLOCK,
                stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                encoding="utf-8", errors="replace", check=False)
            code, output = done.returncode, done.stdout
        except subprocess.TimeoutExpired:
            code, output = None, f"still running after {SECONDS_OF_A_BLOCK} s"
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        used = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
        return code, output, used


def complaints(block, code, output, work):
    """Returns why the outcome is not as the page says."""
    found = []
    expected = int(block.marks.get("exit", 0))
    if code != expected:
        found.append(f"exit code {code}, expected {expected}:\n{output.rstrip()}")
    for name in block.names:
        if not any(work.glob(name.rstrip("/"))):
            found.append(f"there is no {name}, which the text names")
    for line in missing(block.prints, output):
        found.append(f"did not print: {line}\nbut:\n{output.rstrip()}")
    return found


def run_page(page, work):
    """Runs the page; returns the number of blocks that failed and the processor seconds."""
    text = page.read_text(encoding="utf-8")
    env = environment(work, text)
    shell, failed, total = Shell(work, env), 0, 0.0
    for block in steps(text):
        where = f"{page.name}:{block.line}"
        first = block.text.strip().splitlines()[0]
        if not block.runs:
            print(f"{where}: not run ({block.marks['not run']}): {first}")
            continue
        condition = block.marks.get("run if")
        if condition and subprocess.run(["bash", "-c", condition], cwd=work, env=env,
                                        check=False, stdout=subprocess.DEVNULL).returncode:
            print(f"{where}: skipped, not '{condition}': {first}")
            continue
        code, output, used = shell.run(block.text)
        found = complaints(block, code, output, work)
        failed += bool(found)
        total += used
        print(f"{where}: {'FAILED' if found else 'ok'}, {used:.1f} processor s: {first}")
        for complaint in found:
            print("    " + complaint.replace("\n", "\n    "))
        sys.stdout.flush()
    return failed, total


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--source", type=pathlib.Path, required=True)
    parser.add_argument("--program", type=pathlib.Path, required=True)
    parser.add_argument("--work", type=pathlib.Path, required=True)
    parser.add_argument("page")
    options = parser.parse_args()
    work = options.work.resolve()
    if not any(block.runs for block in steps((options.source / options.page).read_text("utf-8"))):
        print(f"{options.page}: no command that runs")
        return 0
    prepare(work, options.source.resolve(), options.program.resolve())
    failed, total = run_page(options.source / options.page, work)
    print(f"{options.page}: {failed} failed, {total:.1f} processor s")
    if not failed:
        shutil.rmtree(work)
    return 1 if failed else 0


if __name__ == "__main__":
    os.umask(0o022)
    sys.exit(main())
