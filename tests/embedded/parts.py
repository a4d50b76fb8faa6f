#!/usr/bin/env python3
"""The text of the library by the parts of it that a program calls: a table, held against a limit.

Usage: parts.py --limit BYTES --limited NAME NAME=MAP...

NAME says what a program calls besides what those before it call; MAP is its linker's map. What the
linker kept of the library's archives counts.
"""

import argparse
import sys
from pathlib import Path

from image import contributions

ARCHIVES = ("libetcm_mesh.a", "libetcm_analysis.a")


def text_of(map_file):
    return sum(size for output, size, source in contributions(map_file)
               if output == ".text" and source and any(name in source for name in ARCHIVES))


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--limit", type=int, required=True)
    parser.add_argument("--limited", required=True)
    parser.add_argument("programs", nargs="+")
    arguments = parser.parse_args()
    faults = []
    before = 0
    print("| a program that calls | text in all | more |\n|---|---:|---:|")
    for program in arguments.programs:
        name, _, map_file = program.partition("=")
        text = text_of(Path(map_file))
        print(f"| {name} | {text} | {text - before} |")
        if text <= before:
            faults.append(f"{name} takes no text of its own: is it called?")
        if name == arguments.limited and text > arguments.limit:
            faults.append(f"the library's text with {name} is {text}, limit {arguments.limit}")
        before = text
    print("\n".join(f"parts: {fault}" for fault in faults) or "within the limit")
    sys.exit(1 if faults else 0)


if __name__ == "__main__":
    main()
