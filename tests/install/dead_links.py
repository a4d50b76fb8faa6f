#!/usr/bin/env python3
"""No link of the installed documents is dead. Usage: dead_links.py FOLDER INCLUDE

Each link of a document leads to a file below FOLDER, and to a heading of it; and each document and each
header that a document or a header names, as docs/work.md or etcm/mesh.h, is there.
"""

import re
import sys
from pathlib import Path

LINK = re.compile(r"\]\(([^)\s]+)\)")
FENCED = re.compile(r"^```.*?^```", re.M | re.S)


def anchors(text):
    for heading in re.findall(r"^#+ +(.*)$", text, re.M):
        yield re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-")


def faults(folder, include):
    documents = sorted(folder.rglob("*.md"))
    if len(documents) < 10:
        yield f"{folder} has {len(documents)} documents"
    for document in documents:
        text = FENCED.sub("", document.read_text())
        for link in LINK.findall(text):
            if re.match(r"[a-z]+:", link):
                continue
            path, _, anchor = link.partition("#")
            target = (document.parent / path).resolve() if path else document
            if not target.is_relative_to(folder) or not target.exists():
                yield f"{document}: {link} leads nowhere"
            elif anchor and anchor not in anchors(target.read_text()):
                yield f"{document}: {link} names no heading"
    for source in [*documents, *sorted(include.rglob("*.h")), *sorted(folder.glob("examples/*.[ch]*"))]:
        text = source.read_text()
        for name in re.findall(r"(?<![\w/])docs/[\w-]+\.md", text):
            if not (folder / name).is_file():
                yield f"{source} names {name}, which is not installed"
        for name in re.findall(r"(?<![\w/])etcm/[\w/]+\.h\b", text):
            if not (include / name).is_file():
                yield f"{source} names {name}, which is not installed"
        if source.suffix == ".h" and re.search(r"\blib/(docs|README)", text):
            yield f"{source} names a document as it is in the sources alone"


def main():
    found = list(faults(Path(sys.argv[1]).resolve(), Path(sys.argv[2]).resolve()))
    sys.exit("\n".join(f"dead_links: {fault}" for fault in found) or 0)


if __name__ == "__main__":
    main()
