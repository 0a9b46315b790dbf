#!/usr/bin/env python3
"""Checks the commands of all pages that need not run for it.

    check_commands.py --source ROOT --program build/ci/apps/flextip

In README.md, docs/tour.md, docs/live.md and docs/usage/ every command stands in a block of ```sh, so that
run_page.py runs it, or in a block marked with a reason why not. Commands and options that the text
of any page names are known to the program.
"""
import argparse
import pathlib
import re
import subprocess
import sys

from markdown_page import inline_commands, unmarked

HINT = "a command to copy stands in a block of ```sh, or below <!-- not run: WHY -->"


def pages_that_run(source):
    return [source / "README.md", source / "docs/tour.md", source / "docs/live.md",
            *sorted(source.glob("docs/usage/*.md"))]


class Help:
    """What the program says of its commands; asked once each."""

    def __init__(self, program):
        self.program, self.texts = program, {}

    def of(self, words):
        """Returns the help of a command; None where there is no such command."""
        if words not in self.texts:
            asked = subprocess.run([self.program, *words, "--help"], capture_output=True,
                                   encoding="utf-8", timeout=60, check=False)
            known = f"Usage: flextip {' '.join(words)} " in asked.stdout
            self.texts[words] = asked.stdout if known else None
        return self.texts[words]

    def complaint(self, command):
        """Returns why the program does not know `flextip WORD ... --option`; empty where it does."""
        command, _, of_items = command.partition(" -- ")
        tokens = re.split(r"[\s=]+", command)[1:]
        if of_items and tokens[0] == "batch":  # options of the command that it runs
            return self.complaint(command) or self.complaint(f"flextip {tokens[1]} {of_items}")
        if not tokens or not re.fullmatch(r"[a-z][a-z-]*", tokens[0]):
            return ""
        words = (tokens[0],)
        if tokens[0] == "help":
            return ""
        if len(tokens) > 1 and re.fullmatch(r"[a-z][a-z-]*", tokens[1]):
            if self.of(words + (tokens[1],)):
                words += (tokens[1],)
        text = self.of(words)
        if text is None:
            return f"the program knows no command '{' '.join(words)}'"
        known = set(re.findall(r"--[a-z][a-z-]*", text)) | {"--help", "--quiet", "--version"}
        options = re.findall(r"(?<![\w-])--[a-z][a-z-]*", command)
        strange = [option for option in options if option not in known]
        return f"'{' '.join(words)}' has no option {', '.join(strange)}" if strange else ""


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--source", type=pathlib.Path, required=True)
    parser.add_argument("--program", type=pathlib.Path, required=True)
    options = parser.parse_args()
    found = []
    for page in pages_that_run(options.source):
        for number in unmarked(page.read_text(encoding="utf-8")):
            found.append(f"{page.relative_to(options.source)}:{number}: {HINT}")
    help_texts, count = Help(options.program), 0
    for page in [options.source / "README.md", *sorted(options.source.glob("docs/**/*.md"))]:
        for number, command in inline_commands(page.read_text(encoding="utf-8")):
            count += 1
            complaint = help_texts.complaint(command)
            if complaint:
                found.append(f"{page.relative_to(options.source)}:{number}: {complaint}")
    for line in found:
        print(line)
    print(f"{count} commands in the text, {len(found)} complaints")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
