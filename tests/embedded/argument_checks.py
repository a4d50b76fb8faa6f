#!/usr/bin/env python3
"""What the checks of arguments take: the library's text in an image with them and in one without.

Usage: argument_checks.py --limit BYTES MAP LIBRARY MAP_WITHOUT LIBRARY_WITHOUT
"""

import argparse
import sys
from pathlib import Path

from image import COLUMNS, contributions


def text_of(map_file, library):
    return sum(size for output, size, source in contributions(map_file)
               if COLUMNS.get(output) == "text" and source is not None and library in source)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--limit", type=int, required=True)
    parser.add_argument("map", type=Path)
    parser.add_argument("library")
    parser.add_argument("map_without", type=Path)
    parser.add_argument("library_without")
    arguments = parser.parse_args()
    with_checks = text_of(arguments.map, arguments.library)
    without = text_of(arguments.map_without, arguments.library_without)
    taken = with_checks - without
    print(f"text of the library: {with_checks} bytes with checks, {without} without, so they take "
          f"{taken} of {arguments.limit}")
    # None at all would mean that nothing is checked, or that the option leaves nothing out.
    sys.exit(0 if without > 0 and 0 < taken <= arguments.limit else 1)


if __name__ == "__main__":
    main()
