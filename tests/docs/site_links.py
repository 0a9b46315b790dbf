#!/usr/bin/env python3
"""Checks every link, picture and script of a built site: site_links.py SITE

A link must lead to a file of the site, and an anchor to an element of that page. Nothing may be
loaded from a network; links to other sites are not followed.
"""
import html.parser
import pathlib
import sys
import urllib.parse


class Page(html.parser.HTMLParser):
    """The links of a page, what it loads, and the names that links can reach."""

    def __init__(self, text):
        super().__init__()
        self.links, self.loads, self.anchors = [], [], {""}
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        attrs = dict(attrs)
        self.anchors.add(attrs.get("id") or attrs.get("name") or "")
        if tag == "a" and attrs.get("href"):
            self.links.append(attrs["href"])
        if attrs.get("src"):
            self.loads.append(attrs["src"])
        if tag == "link" and attrs.get("href") and attrs.get("rel") != "canonical":
            self.loads.append(attrs["href"])


def read_pages(site):
    # 404.html is served at any place, so that its links begin at the server's root.
    return {path.resolve(): Page(path.read_text(encoding="utf-8"))
            for path in sorted(site.rglob("*.html")) if path.name != "404.html"}


def complaint(page, link, pages):
    """Returns why a link leads nowhere; empty where it leads somewhere or out of the site."""
    parts = urllib.parse.urlsplit(link)
    if parts.scheme or parts.netloc:
        return ""
    path = urllib.parse.unquote(parts.path)
    target = (page.parent / path).resolve() if path else page
    if target.is_dir():
        target = target / "index.html"
    if not target.is_file():
        return f"{link}: there is no such file"
    anchor = urllib.parse.unquote(parts.fragment)
    if target in pages and anchor not in pages[target].anchors:
        return f"{link}: the page has no such anchor"
    return ""


def check(site):
    """Returns the complaints about all pages, and the number of links looked at."""
    pages, found, count = read_pages(site), [], 0
    for path, page in pages.items():
        where = path.relative_to(site.resolve())
        for link in page.links + page.loads:
            count += 1
            why = complaint(path, link, pages)
            if why:
                found.append(f"{where}: {why}")
        outside = [load for load in page.loads if urllib.parse.urlsplit(load).scheme in ("http", "https")]
        found += [f"{where}: {load}: loaded from a network" for load in outside]
    return found, count


def main():
    site = pathlib.Path(sys.argv[1])
    found, count = check(site)
    for line in found:
        print(line)
    print(f"{count} links, {len(found)} broken")
    return 1 if found or count == 0 else 0


if __name__ == "__main__":
    sys.exit(main())
