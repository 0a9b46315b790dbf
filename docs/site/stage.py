#!/usr/bin/env python3
"""Lays out the pages for mkdocs: stage.py ROOT STAGE SITE

STAGE gets every page of the project at its place in the tree, so that links between them stay as
they are, all files that pages link to, and the configuration with the navigation. SITE is where
mkdocs will write.
"""
import json
import pathlib
import re
import shutil
import sys

SKIPPED = {"build", "out", "node_modules", ".git"}
LINK = re.compile(r"\]\(([^)\s#]+)(?:#[^)\s]*)?\)")
# The sections of the navigation, with the pages that come first; a section takes the rest of its
# folder in alphabetical order, so that a new page is never left out.
SECTIONS = [
    ("Start", None, ["docs/README.md", "docs/tour.md", "docs/troubleshooting.md",
                     "docs/glossary.md"]),
    ("Use", "docs/usage", ["docs/usage/recordings.md", "docs/usage/check.md",
                           "docs/usage/collar.md", "docs/usage/calibrate.md",
                           "docs/usage/track.md", "docs/usage/estimate.md",
                           "docs/usage/diagnose.md", "docs/usage/predict.md",
                           "docs/usage/simulate.md",
                           "docs/scenarios.md", "docs/usage/maps.md", "docs/effects.md"]),
    ("How it works", "docs/method", ["docs/method/models.md", "docs/method/vision.md",
                                     "docs/method/diagnosis.md"]),
    ("How well it works", "docs/results", ["docs/results/models.md", "docs/results/vision.md",
                                           "docs/results/diagnosis.md",
                                           "docs/results/calibration.md"]),
    ("The thesis done again", "docs/results/reproduction",
     ["docs/results/reproduction.md", "docs/errata.md"]),
    ("What was tried", "docs/notes", []),
    ("Live", "docs/live", ["docs/live.md", "docs/live/protocols.md"]),
    ("Reference", "docs", ["docs/formats.md", "docs/architecture.md", "docs/building.md",
                           "docs/dependencies.md"]),
]


def project_files(root):
    """Returns the files of the project, without what is built or fetched."""
    files = []
    for path in sorted(root.iterdir()):
        if path.is_dir() and path.name not in SKIPPED:
            files += project_files(path)
        elif path.is_file():
            files.append(path)
    return files


def stage_pages(root, stage):
    """Copies pages, pictures and what pages link to; returns the pages' names."""
    pages = []
    wanted = set()
    for file in project_files(root):
        name = file.relative_to(root).as_posix()
        if name.startswith("tests/"):
            continue
        if file.suffix == ".md":
            pages.append(name)
            wanted.add(file)
            for link in LINK.findall(file.read_text(encoding="utf-8")):
                target = (file.parent / link).resolve()
                if target.is_file() and target.is_relative_to(root):
                    wanted.add(target)
    for file in sorted(wanted):
        target = stage / file.relative_to(root)
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(file, target)
    return [page for page in pages if (stage / page).exists()]


def title(root, page):
    """Returns the first heading of a page; of a folder's README the folder."""
    folder = pathlib.PurePosixPath(page).parent.as_posix()
    if page.endswith("README.md") and folder != "docs":
        return folder + "/"
    text = (root / page).read_text(encoding="utf-8")
    heading = re.search(r"^# (.+)$", text, re.MULTILINE)
    return re.sub(r"[`*]", "", heading[1]) if heading else page


def navigation(root, pages):
    """Returns mkdocs's nav: each page once."""
    left, nav = set(pages) - {"README.md"}, [{"Overview": "README.md"}]
    named = {page for _, _, first in SECTIONS for page in first}
    for name, folder, first in SECTIONS:
        inside = [page for page in pages if pathlib.PurePosixPath(page).parent.as_posix() == folder]
        listed = [page for page in first if page in left]
        listed += [page for page in inside if page in left and page not in named]
        left -= set(listed)
        nav.append({name: [{title(root, page): page} for page in listed]})
    folders = sorted(page for page in left if page.endswith("README.md"))
    others = sorted(left - set(folders))
    nav.append({"The code": [{title(root, page): page} for page in folders]})
    if others:
        nav.append({"More": [{title(root, page): page} for page in others]})
    return nav


def main():
    root, stage, site = (pathlib.Path(name).resolve() for name in sys.argv[1:])
    shutil.rmtree(stage, ignore_errors=True)
    pages = stage_pages(root, stage / "pages")
    for name in ("hooks.py", "theme"):
        source = root / "docs/site" / name
        copy = shutil.copytree if source.is_dir() else shutil.copyfile
        copy(source, stage / name)
    settings = {"docs_dir": str(stage / "pages"), "site_dir": str(site),
                "nav": navigation(root, pages)}
    text = (root / "docs/site/mkdocs.yml").read_text(encoding="utf-8")
    # A value in JSON is one in YAML.
    text += "".join(f"{key}: {json.dumps(value)}\n" for key, value in settings.items())
    (stage / "mkdocs.yml").write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
