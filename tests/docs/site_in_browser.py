#!/usr/bin/env python3
"""Looks at the built site in a browser, as a reader does: site_in_browser.py SITE

The front page has its title and its picture, the search finds a word from a server and from the
disk, and no page is wider than a phone.
"""
import json
import pathlib
import sys

from browser import SKIPPED, chromium, dom_of_file, run_checks

WORD = "NEES"
SCRIPT = """
const result = {};
let page = await look("/index.html", 1200);
result.title = page.title;
await until(() => [...page.images].every((image) => image.complete), 10);
result.pictures = [...page.images].map((image) => image.naturalWidth);
page = await look("/index.html?q=%(word)s", 1200);
const found = () => [...page.querySelectorAll(".md-search-result__item")];
await until(() => found().length > 0, 20);
result.found = found().map((item) => item.textContent);
result.wide = [];
for (const name of %(pages)s) {
  page = await look("/" + name, 390);
  await wait(30);
  const width = page.scrollingElement.scrollWidth;
  if (width > 390) result.wide.push(name + ": " + width + " px");
  if (![...page.images].every((image) => image.complete && image.naturalWidth > 0))
    result.wide.push(name + ": a picture is missing");
}
return result;
"""


def complaints(result, dom):
    """Returns why the reader would not be content."""
    if "error" in result:
        return [result["error"]]
    found = []
    if result["title"] != "flextip":
        found.append(f"the front page's title is {result['title']!r}")
    if not result["pictures"] or min(result["pictures"]) == 0:
        found.append(f"pictures of the front page have widths {result['pictures']}")
    if not any(WORD in text for text in result["found"]):
        found.append(f"the search does not find {WORD}: {len(result['found'])} results")
    if 'class="md-search-result__item"' not in dom or WORD not in dom:
        found.append(f"the search does not find {WORD} in pages opened as files")
    return found + result["wide"]


def main():
    site = pathlib.Path(sys.argv[1]).resolve()
    if not chromium():
        print("skipped: no chromium")
        return SKIPPED
    if not (site / "index.html").is_file():
        print(f"skipped: {site} was not built")
        return SKIPPED
    pages = sorted(path.relative_to(site).as_posix() for path in site.rglob("*.html")
                   if path.name != "404.html")
    result = run_checks(site, SCRIPT % {"word": WORD, "pages": json.dumps(pages)}, 240)
    found = complaints(result, dom_of_file(site / "index.html", f"?q={WORD}", 20))
    for line in found:
        print(line)
    print(f"{len(pages)} pages looked at, {len(found)} complaints")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
