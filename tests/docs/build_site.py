#!/usr/bin/env python3
"""Builds the documentation site and checks its links: build_site.py --source ROOT --site FOLDER"""
import argparse
import pathlib
import shutil
import subprocess
import sys
import tempfile

from browser import SKIPPED
from site_links import check


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--source", type=pathlib.Path, required=True)
    parser.add_argument("--site", type=pathlib.Path, required=True)
    options = parser.parse_args()
    mkdocs = shutil.which("mkdocs")
    if not mkdocs:
        print("skipped: no mkdocs")
        return SKIPPED
    with tempfile.TemporaryDirectory() as stage:
        subprocess.run([sys.executable, options.source / "docs/site/stage.py", options.source, stage,
                        options.site], check=True)
        built = subprocess.run([mkdocs, "--quiet", "build", "--clean", "--config-file",
                                f"{stage}/mkdocs.yml"], check=False)
    if built.returncode:
        return 1
    found, count = check(options.site)
    for line in found:
        print(line)
    print(f"{count} links, {len(found)} broken")
    return 1 if found or count == 0 else 0


if __name__ == "__main__":
    sys.exit(main())
