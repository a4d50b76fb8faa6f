#!/usr/bin/env python3
"""What the libraries ask of whoever links them: nothing but what each compiler of C brings.

Usage: c_symbols.py --nm NM ARCHIVE...

That is the four functions of memory which any of them may call, and the compiler's own run-time for
integers and doubles. No C++ run-time, no mathematical library, no operating system.
"""

import argparse
import re
import subprocess
import sys

MEMORY = {"memcpy", "memmove", "memset", "memcmp"}
COMPILER = re.compile(r"^__(aeabi_\w+|[a-z]+[sdtx][ifc][0-9]?|gnu_thumb\w*|clz\w+|popcount\w+)$")
# Where a program may take over; the libraries have them too.
TAKEN_OVER = {"_GLOBAL_OFFSET_TABLE_"}


def symbols(nm, option, archive):
    listing = subprocess.run([nm, option, "--format=posix", archive], check=True,
                             capture_output=True, text=True).stdout
    return {line.split()[0] for line in listing.splitlines() if len(line.split()) >= 2}


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--nm", required=True)
    parser.add_argument("archives", nargs="+")
    arguments = parser.parse_args()
    defined, wanted = set(), set()
    for archive in arguments.archives:
        defined |= symbols(arguments.nm, "--defined-only", archive)
        wanted |= symbols(arguments.nm, "--undefined-only", archive)
    if "etcm_join" not in defined:
        sys.exit("c_symbols: the archives have no etcm_join()")
    asked = wanted - defined - TAKEN_OVER
    foreign = sorted(name for name in asked if name not in MEMORY and not COMPILER.match(name))
    print("asked of the linker:", " ".join(sorted(asked)) or "nothing")
    if foreign:
        sys.exit(f"c_symbols: a C program cannot be linked without: {' '.join(foreign)}")


if __name__ == "__main__":
    main()
