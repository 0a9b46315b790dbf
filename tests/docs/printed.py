"""Whether a program printed the lines that a page shows."""
import re

NUMBER = r"-?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?"


def matches(shown, line, tolerance=0.1):
    """Whether a line has the words of the one shown, with numbers at most `tolerance` apart.

    An ellipsis in the line shown stands for any text; runs of blanks are alike.
    """
    parts = re.split(f"({NUMBER})", re.sub(r"\s+", " ", shown.strip()))
    pattern = ""
    for i, part in enumerate(parts):
        if i % 2:
            pattern += f"({NUMBER})"
        else:
            pattern += re.escape(part).replace(r"\ ", r"\s+").replace("…", ".*")
    found = re.fullmatch(r"\s*" + pattern + r"\s*", line)
    if not found:
        return False
    for text, value in zip(parts[1::2], found.groups()):
        decimals = len(text.partition(".")[2])
        room = tolerance * abs(float(text)) + 10.0**-decimals
        if abs(float(text) - float(value)) > room:
            return False
    return True


def missing(shown, output):
    """Returns the lines shown that the output does not have, in this order."""
    lines, absent, at = output.splitlines(), [], 0
    for line in shown:
        if line.strip() in ("", "…"):
            continue
        hit = next((i for i in range(at, len(lines)) if matches(line, lines[i])), None)
        if hit is None:
            absent.append(line)
        else:
            at = hit + 1
    return absent
