"""What the site needs beside mkdocs: two dialects of Markdown, and an index for pages as files."""
import pathlib
import re

FENCE = re.compile(r"^( *)```")
ITEM = re.compile(r"^([-*]|\d+\.) ")


def on_page_markdown(markdown, **_):
    """Parts of list items are indented by two or three blanks in the pages, by four for mkdocs."""
    lines, in_list, shift, fenced, before = [], False, 0, False, ""
    for line in markdown.splitlines():
        indent = len(line) - len(line.lstrip(" "))
        fence = FENCE.match(line)
        if fenced:
            lines.append(" " * shift + line)
            fenced = not fence
            continue
        if line.strip() and indent == 0:
            in_list = bool(ITEM.match(line)) or (in_list and bool(before.strip()))
        shift = 4 - indent if in_list and 2 <= indent <= 3 else 0
        fenced = bool(fence)
        lines.append(" " * shift + bars_in_code(line))
        before = line
    return "\n".join(lines) + "\n"


def bars_in_code(line):
    """A bar in code in a table is written with a backslash, which is not for the reader."""
    if not line.lstrip().startswith("|"):
        return line
    return re.sub(r"`[^`]+`", lambda code: code[0].replace(r"\|", "|"), line)


def on_post_build(config, **_):
    """The search index as a script, for pages that are opened as files."""
    search = pathlib.Path(config["site_dir"]) / "search"
    index = (search / "search_index.json").read_text(encoding="utf-8")
    (search / "search_index.js").write_text(f"takeSearchIndex({index});\n", encoding="utf-8")
