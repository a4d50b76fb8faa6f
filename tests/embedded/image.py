#!/usr/bin/env python3
"""What a program for a bare machine is made of: a table, held against limits.

Usage: image.py --nm NM --map MAP --library ARCHIVE --library-text-limit BYTES --ram-limit BYTES
                IMAGE -- EMULATOR...

What the linker kept of the archive is the size of what the image uses of the library, which is most
of it. The last row of the table comes from running the image, which reports its stack.
"""

import argparse
import re
import subprocess
import sys
from pathlib import Path

# In no image: whoever allocates, throws, looks up types at run time or prints through stdio.
FORBIDDEN = re.compile(
    r"^(_Zn[wa]|_Zd[la]|_?(malloc|calloc|realloc|free|memalign|aligned_alloc)(_r)?|_?sbrk(_r)?"
    r"|__cxa_(throw|allocate|begin_catch|pure|guard|atexit).*|_Unwind_.*|__gxx_personality.*"
    r"|__dynamic_cast|_ZT[ISV].*|_ZSt\d*__throw.*|.*printf(_r)?|_?(puts|fwrite|fopen)(_r)?|abort)$")

# Output section, and the column it counts in.
COLUMNS = {".text": "text", ".ARM.exidx": "text", ".data": "data", ".bss": "bss", ".stack": "stack"}
EMPTY = {"text": 0, "data": 0, "bss": 0, "stack": 0}


def contributions(map_file):
    """(output section, bytes, file) of each piece in the linker's map, and with no file for each
    section as a whole: the linker fills up between pieces, and the stack is no piece of any file."""
    text = map_file.read_text().split("Linker script and memory map", 1)[1]
    # A long name stands on a line of its own.
    text = re.sub(r"\n( ?[.\w$]+)\n +0x", r"\n\1 0x", text)
    output = None
    for line in text.splitlines():
        if match := re.match(r"(\.[.\w]+) +0x[0-9a-f]+ +0x([0-9a-f]+)", line):
            output = match.group(1)
            yield output, int(match.group(2), 16), None
        elif match := re.match(r" ([.\w$]+) +0x[0-9a-f]+ +0x([0-9a-f]+) (\S.*)$", line):
            yield output, int(match.group(2), 16), match.group(3)


def table_of(arguments):
    rows = {"library": dict(EMPTY), "compiler and C run-time": dict(EMPTY),
            "test program": dict(EMPTY), "the image": dict(EMPTY)}
    for output, size, source in contributions(arguments.map):
        if output not in COLUMNS:
            continue
        if source is None:
            row = "the image"
        elif arguments.library.name in source:
            row = "library"
        elif re.search(r"lib(gcc|c|c_nano|stdc\+\+\w*)\.a", source):
            row = "compiler and C run-time"
        else:
            row = "test program"
        rows[row][COLUMNS[output]] += size
    return rows


def symbols_of(arguments):
    listing = subprocess.run([arguments.nm, "--format=posix", arguments.image], check=True,
                             capture_output=True, text=True).stdout
    return [line.split()[0] for line in listing.splitlines()]


def stack_used(arguments):
    result = subprocess.run([*arguments.emulator, arguments.image], capture_output=True, text=True)
    match = re.search(r"^# stack used: (\d+) of (\d+)$", result.stdout, re.M)
    if result.returncode != 0 or not match:
        sys.exit(f"image: the program ended with {result.returncode}:\n{result.stdout}{result.stderr}")
    return int(match.group(1))


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--nm", required=True)
    parser.add_argument("--map", type=Path, required=True)
    parser.add_argument("--library", type=Path, required=True)
    parser.add_argument("--library-text-limit", type=int, required=True)
    parser.add_argument("--ram-limit", type=int, required=True)
    parser.add_argument("image")
    middle = sys.argv.index("--")
    arguments = parser.parse_args(sys.argv[1:middle])
    arguments.emulator = sys.argv[middle + 1:]

    rows = table_of(arguments)
    print(f"{'bytes':26}" + "".join(f"{column:>9}" for column in EMPTY))
    for name, row in rows.items():
        print(f"{name:26}" + "".join(f"{row[column]:9}" for column in EMPTY))
    used = stack_used(arguments)
    print(f"stack used when run: {used}")

    faults = []
    library, image = rows["library"], rows["the image"]
    if not library["text"]:
        faults.append("the map names nothing of the library")
    if library["text"] > arguments.library_text_limit:
        faults.append(f"the library's text is {library['text']}, limit {arguments.library_text_limit}")
    if library["data"] or library["bss"]:
        faults.append("the library has data of its own; all its state belongs in the caller's memory")
    ram = image["data"] + image["bss"] + image["stack"]
    print(f"RAM: {ram} of {arguments.ram_limit}")
    if ram > arguments.ram_limit:
        faults.append(f"RAM is {ram}, limit {arguments.ram_limit}")
    if used >= image["stack"]:
        faults.append("the stack was used up")
    faults += [f"{name} is in the image" for name in symbols_of(arguments) if FORBIDDEN.match(name)]
    print("\n".join(f"image: {fault}" for fault in faults) or "within all limits")
    sys.exit(1 if faults else 0)


if __name__ == "__main__":
    main()
