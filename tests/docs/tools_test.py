#!/usr/bin/env python3
"""Tests of the scripts of this folder: each rule sees what it is there for."""
import pathlib
import tempfile
import unittest

from markdown_page import inline_commands, steps, unmarked
from printed import matches, missing
from site_links import check

PAGE = """# A page

Text with `out/before`.

```sh
flextip shape --force 0,0,-2
```

It writes `out/a.png` and `out/b/*.csv`, not `other/c`.

```text
tip  12.5 mm
```

<!-- not run: a camera is needed -->

```sh
flextip track --live 0
```

It would write `out/live`.

<!-- run if: test -e /photos -->
<!-- exit: 1 -->
```sh
flextip check x
```
"""


class Steps(unittest.TestCase):
    def test_blocks_come_with_marks_and_what_the_text_after_them_names(self):
        first, second, third = steps(PAGE)
        self.assertEqual(first.text, "flextip shape --force 0,0,-2\n")
        self.assertTrue(first.runs)
        self.assertEqual(first.names, ["out/a.png", "out/b/*.csv"])
        self.assertEqual(first.prints, ["tip  12.5 mm"])
        self.assertFalse(second.runs)
        self.assertEqual(second.names, ["out/live"])
        self.assertEqual(third.marks, {"run if": "test -e /photos", "exit": "1"})

    def test_a_mark_holds_for_the_next_block_alone(self):
        text = "<!-- not run: x -->\nwords\n```sh\nflextip a\n```\n"
        self.assertTrue(steps(text)[0].runs)

    def test_blocks_in_lists_lose_their_indent(self):
        self.assertEqual(steps("1. do\n\n   ```sh\n   flextip a\n     b\n   ```\n")[0].text,
                         "flextip a\n  b\n")


class Unmarked(unittest.TestCase):
    def test_commands_outside_of_sh_blocks_are_seen(self):
        self.assertEqual(unmarked("```\nflextip a\n```\n"), [2])
        self.assertEqual(unmarked("```console\n$ ./scripts/demo\n```\n"), [2])
        self.assertEqual(unmarked("Do:\n\n    flextip a\n"), [3])

    def test_marked_blocks_and_other_text_are_not(self):
        self.assertEqual(unmarked(PAGE), [])
        self.assertEqual(unmarked("<!-- not run: why -->\n```\nflextip a\n```\n"), [])
        self.assertEqual(unmarked("flextip follows a tip.\n\n```cpp\nint flextip;\n```\n"), [])


class Inline(unittest.TestCase):
    def test_commands_in_the_text_are_found(self):
        self.assertEqual(inline_commands("a `flextip check R` b `x`\n```\n`flextip no`\n```\n"),
                         [(1, "flextip check R")])


class Printed(unittest.TestCase):
    def test_words_must_agree_and_numbers_nearly(self):
        self.assertTrue(matches("tip 12.5 mm", "  tip   12.9 mm"))
        self.assertFalse(matches("tip 12.5 mm", "tip 14.5 mm"))
        self.assertFalse(matches("tip 12.5 mm", "top 12.5 mm"))
        self.assertFalse(matches("tip 12.5 mm", "tip -12.5 mm"))
        self.assertTrue(matches("tip … mm", "tip is at 3 mm"))

    def test_lines_are_wanted_in_order(self):
        self.assertEqual(missing(["a 1", "…", "b 2"], "a 1\nx\nb 2\n"), [])
        self.assertEqual(missing(["b 2", "a 1"], "a 1\nb 2\n"), ["a 1"])


class SiteLinks(unittest.TestCase):
    def test_broken_links_anchors_and_foreign_files_are_seen(self):
        with tempfile.TemporaryDirectory() as folder:
            site = pathlib.Path(folder)
            (site / "a.html").write_text(
                '<a href="b.html#x">x</a><a href="b.html#y">y</a><a href="c.html">c</a>'
                '<a href="https://elsewhere">e</a><img src="https://elsewhere/p.png">')
            (site / "b.html").write_text('<h1 id="x">x</h1><a href="a.html">a</a>')
            found, count = check(site)
        self.assertEqual(found, ["a.html: b.html#y: the page has no such anchor",
                                 "a.html: c.html: there is no such file",
                                 "a.html: https://elsewhere/p.png: loaded from a network"])
        self.assertEqual(count, 6)


if __name__ == "__main__":
    unittest.main()
