#!/usr/bin/env python3
"""Fails unless two commands print the same lines; those that begin with '#' may differ.

Usage: same_lines.py COMMAND... -- COMMAND...
"""

import difflib
import os
import subprocess
import sys


def lines_of(command):
    if not os.path.exists(command[0]) and "/" in command[0]:
        sys.exit(f"same_lines: {command[0]} does not exist; build what it belongs to first "
                 "(for a cross build: cmake --build --preset release)")
    result = subprocess.run(command, capture_output=True, text=True)
    if result.returncode != 0:
        sys.exit(f"same_lines: {' '.join(command)} ended with {result.returncode}:\n"
                 f"{result.stdout}{result.stderr}")
    return [line for line in result.stdout.splitlines() if not line.startswith("#")]


def main():
    arguments = sys.argv[1:]
    if arguments.count("--") != 1:
        sys.exit(__doc__)
    middle = arguments.index("--")
    expected = lines_of(arguments[:middle])
    found = lines_of(arguments[middle + 1:])
    if not expected:
        sys.exit(f"same_lines: {arguments[0]} prints nothing to compare")
    difference = list(difflib.unified_diff(expected, found, "the first", "the second", lineterm=""))
    print("\n".join(difference) or f"{len(expected)} equal lines")
    sys.exit(1 if difference else 0)


if __name__ == "__main__":
    main()
