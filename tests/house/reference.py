#!/usr/bin/env python3
"""The reference says what the headers say. Usage: reference.py CMAKE BUILD

Makes the target etcm_reference, which fails on a warning, and looks into it: there is a page for each
header, and the contracts of calls are with the calls.
"""

import html
import re
import subprocess
import sys
from pathlib import Path

HEADERS = Path(__file__).resolve().parents[2] / "lib/include/etcm"
CONTRACTS = [("*Mesh.html", "A node joins. It may stand on a Steiner vertex"),
             ("work_8h.html", "counted, not timed"),
             ("structetcm*MeshConfig.html", "Nodes and Steiner vertices together"),
             ("c_2mesh_8h.html", "A node moves, keeps its id, and the features that end at it follow it"),
             ("c_2mesh_8h.html", "Whether etcm_open() would take the configuration"),
             ("structetcm*config*.html", "What is decided once"),
             ("c_2types_8h.html", "no vertices, a policy without a function, too wide for ids"),
             ("c_2types_8h.html", "the vertex capacity is used up"),
             ("index.html", "what always holds, and each call")]
# Headings of groups, which are the text of no member.
HEADINGS = ("The arguments", "Room and bounds: normal answers")


def main():
    cmake, build = sys.argv[1:]
    made = subprocess.run([cmake, "--build", build, "--target", "etcm_reference"],
                          capture_output=True, text=True)
    if made.returncode != 0:
        sys.exit(f"reference: {made.stdout}{made.stderr}")
    pages = {page.name: re.sub(r"\s+", " ", html.unescape(re.sub(r"<[^>]+>", "", page.read_text())))
             for page in Path(build, "lib/reference/html").glob("*.html")}
    faults = [f"{header.name} has no page" for header in HEADERS.rglob("*.h")
              if not any(f"{header.stem.replace('_', '__')}_8h.html" in name for name in pages)]
    faults += [f"{pattern} does not say {phrase!r}" for pattern, phrase in CONTRACTS
               if not any(Path(name).match(pattern) and phrase in text for name, text in pages.items())]
    faults += [f"{name} has the heading {heading!r} for a text" for name, text in pages.items()
               if not name.endswith("_source.html") for heading in HEADINGS if heading in text]
    sys.exit("\n".join(f"reference: {fault}" for fault in faults) or 0)


if __name__ == "__main__":
    main()
