"""The commands of a Markdown page: its code blocks, their marks, and the files its text names.

Marks are comments on the lines above a block:
    <!-- not run: WHY -->     the block is not for the test
    <!-- run if: COMMAND -->  the block runs where this shell command succeeds
    <!-- exit: N -->          the block's last command ends with N
"""
import re
from dataclasses import dataclass, field

FENCE = re.compile(r"^( *)(`{3,})\s*(\w*)\s*$")
MARK = re.compile(r"^\s*<!-- (not run|run if|exit): (.*?) -->\s*$")
COMMAND = re.compile(r"^\s*(?:\$ )?(?:flextip|\./scripts/|scripts/|build/|cmake |sudo |apt)")
NAMED = re.compile(r"(?<!`)`(out/[^`\s]*)`(?!`)")
INLINE = re.compile(r"(?<!`)`(flextip [^`]*)`(?!`)")


@dataclass
class Block:
    """A code block with what the text up to the next block says of its outcome."""

    line: int
    language: str
    text: str = ""
    marks: dict = field(default_factory=dict)
    names: list = field(default_factory=list)  # files that the text after the block names
    prints: list = field(default_factory=list)  # lines of the ```text block after it

    @property
    def runs(self):
        return self.language == "sh" and "not run" not in self.marks


def parse(text):
    """Returns the blocks of a page, and as (line, text) the lines that stand outside of them."""
    blocks, prose, marks = [], [], {}
    block = indent = None
    for number, line in enumerate(text.splitlines(), 1):
        fence = FENCE.match(line)
        if block is not None:
            if fence and not fence[3]:
                blocks.append(block)
                block = None
            else:
                block.text += line[indent:] + "\n"
        elif fence:
            block, indent, marks = Block(number + 1, fence[3], marks=marks), len(fence[1]), {}
        elif mark := MARK.match(line):
            marks[mark[1]] = mark[2]
        else:
            prose.append((number, line))
            if line.strip():
                marks = {}
    return blocks, prose


def steps(text):
    """Returns the blocks of commands in order, with the files named and the lines printed after."""
    blocks, prose = parse(text)
    commands = [block for block in blocks if block.language == "sh"]
    for block in blocks:
        before = [command for command in commands if command.line < block.line]
        if block.language == "text" and before:
            before[-1].prints += block.text.splitlines()
    for number, line in prose:
        before = [command for command in commands if command.line < number]
        if before:
            before[-1].names += NAMED.findall(line)
    return commands


def unmarked(text):
    """Returns the numbers of lines with a command outside of ```sh blocks: copied, but not run."""
    blocks, prose = parse(text)
    found = []
    for block in blocks:
        # Lines of other languages only look like commands.
        if block.language in ("sh", "python", "yaml", "toml") or "not run" in block.marks:
            continue
        lines = enumerate(block.text.splitlines(), block.line)
        found += [number for number, line in lines if COMMAND.match(line)]
    before = ""
    for number, line in prose:
        indented = line.startswith("    ") and not before.lstrip().startswith(("-", "|"))
        if indented and COMMAND.match(line):
            found.append(number)
        before = line or before
    return sorted(found)


def inline_commands(text):
    """Returns (line, command) of each `flextip ...` in the running text and in tables."""
    _, prose = parse(text)
    return [(number, command) for number, line in prose for command in INLINE.findall(line)]
