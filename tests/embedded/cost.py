#!/usr/bin/env python3
"""The tables of lib/docs/cost.md: what the library costs on a machine.

Usage: cost.py --machine NAME --limit INSTRUCTIONS --document FILE [--write] --call-graph SCRIPT --parts NAME=MAP...
               --c-library ARCHIVE --size PROGRAM --objects FILE.o... --program IMAGE -- EMULATOR...

Makes the tables between the marks of that machine anew, from a run of cost_program, from the stack
that the compiler states for each call, and from the linker's maps. Without --write it compares: each
figure of the document is within TOLERANCE of what is measured, or the document is to be made anew.
"""

import argparse
import re
import subprocess
import sys
from pathlib import Path

from image import contributions
from parts import ARCHIVES

TOLERANCE = 0.05
RUNTIME = re.compile(r"lib(gcc|c|c_nano|m|stdc\+\+\w*)\.a")
# What a watchdog of 250 ms leaves. A core takes one to two cycles an instruction: the safe one first.
WATCHDOG_MS = 250
CLOCKS_MHZ = (16, 168)
CYCLES = (2, 1)
# Calls that are part of who makes them.
INLINE = ("edges_of",)


def stacks_of(arguments):
    """Bytes of stack by the name of the public call; the deepest of overloads."""
    result = subprocess.run([sys.executable, arguments.call_graph, "--limit", "100000", "--show", "1000",
                             *arguments.objects], capture_output=True, text=True, check=True)
    stacks = {}
    for size, name in re.findall(r"^ *(\d+)  (?:\S.*? )??((?:etcm::)?[\w:]+)\(", result.stdout, re.M):
        key = re.sub(r"^etcm::(Mesh::)?", "", name)
        stacks[key] = max(stacks.get(key, 0), int(size))
    return stacks


def measured(arguments):
    emulator, image = arguments.emulator, arguments.program
    result = subprocess.run([*emulator, image], capture_output=True, text=True)
    if result.returncode != 0:
        sys.exit(f"cost: the program ended with {result.returncode}:\n{result.stdout}{result.stderr}")
    lines = [line.split(";") for line in result.stdout.splitlines()]
    calls = {line[1]: [int(value) for value in line[2:]] for line in lines if line[0] == "cost"}
    memory = [[int(value) for value in line[1:]] for line in lines if line[0] == "ram"]
    if not calls or not memory:
        sys.exit("cost: the program printed no figures")
    return calls, memory


def spaced(number):
    return f"{number:,}".replace(",", " ")


def table_of_calls(calls, stacks):
    yield "| call | instructions, median | at worst, random | at worst, found | longest between two calls of the hook | stack |"
    yield "|---|---:|---:|---:|---:|---:|"
    for name, (median, worst, found, _, _, longest, *_) in calls.items():
        call = re.split(r"[, ]", name)[0]
        stack = "inline" if call in INLINE else stacks.get(call)
        if stack is None:
            sys.exit(f"cost: the call graph knows no {name}")
        yield (f"| {name} | {spaced(median)} | {spaced(worst)} | {spaced(found)} "
               f"| {spaced(longest) if longest else 'none'} | {stack} |")


def table_of_units(calls, limit):
    gap = max(values[5] for values in calls.values())
    yield (f"| clock | cycles an instruction | units in {WATCHDOG_MS} ms, {spaced(limit)} instructions each "
           "| longest between two calls of the hook, ms |")
    yield "|---|---:|---:|---:|"
    for clock in CLOCKS_MHZ:
        for cycles in CYCLES:
            instructions = clock * 1000 * WATCHDOG_MS // cycles
            yield (f"| {clock} MHz | {cycles} | {spaced(instructions // limit)} "
                   f"| {gap * cycles / (clock * 1000):.1f} |")


def table_of_long_calls(calls):
    """Which need the hook, or a limit."""
    yield f"| clock | cycles an instruction | longer than {WATCHDOG_MS} ms in the median | and at worst, found |"
    yield "|---|---:|---|---|"
    for clock in CLOCKS_MHZ:
        for cycles in CYCLES:
            most = clock * 1000 * WATCHDOG_MS // cycles
            mostly = [name for name, (median, *_) in calls.items() if median > most]
            ever = [name for name, (_, _, found, *_) in calls.items() if found > most and name not in mostly]
            yield f"| {clock} MHz | {cycles} | {'; '.join(mostly) or 'none'} | {'; '.join(ever) or 'none'} |"


def text_of_archive(size, archive):
    result = subprocess.run([size, "--totals", archive], capture_output=True, text=True, check=True)
    return int(result.stdout.splitlines()[-1].split()[0])


def table_of_flash(parts, from_c):
    yield "| a program that calls | the library | the compiler's run-time | in all |"
    yield "|---|---:|---:|---:|"
    for part in parts:
        name, _, map_file = part.partition("=")
        text = {"library": 0, "runtime": 0}
        for output, size, source in contributions(Path(map_file)):
            if output != ".text" or not source:
                continue
            if any(archive in source for archive in ARCHIVES):
                text["library"] += size
            elif RUNTIME.search(source):
                text["runtime"] += size
        yield (f"| {name} | {spaced(text['library'])} | {spaced(text['runtime'])} "
               f"| {spaced(sum(text.values()))} |")
    text["library"] += from_c
    yield (f"| all of it, from C | {spaced(text['library'])} | {spaced(text['runtime'])} "
           f"| {spaced(sum(text.values()))} |")


def table_of_memory(memory):
    yield ("| nodes | features | vertices_max | features_max | storage | save | handles | label_domain "
           "| connectivity |")
    yield "|---:|---:|---:|---:|---:|---:|---:|---:|---:|"
    for row in memory:
        yield "| " + " | ".join(spaced(value) for value in row) + " |"


def differences(before, now):
    """Of two lists of lines, where their texts differ or a figure by more than the tolerance."""
    number = re.compile(r"(?<![\w.])\d[\d ]*\d(?![\w.])|(?<![\w.])\d(?![\w.])|\d+\.\d+")
    if len(before) != len(now):
        yield f"there are {len(before)} lines, and {len(now)} measured"
    for old, new in zip(before, now):
        if number.sub("#", old) != number.sub("#", new):
            yield f"{old!r} is now {new!r}"
            continue
        for a, b in zip(number.findall(old), number.findall(new)):
            a, b = float(a.replace(" ", "")), float(b.replace(" ", ""))
            if abs(a - b) > max(TOLERANCE * max(a, b), 200):
                yield f"{a:g} is now {b:g}: {new}"


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--machine", required=True)
    parser.add_argument("--document", type=Path, required=True)
    parser.add_argument("--limit", type=int, required=True, help="instructions that a unit may take")
    parser.add_argument("--write", action="store_true")
    parser.add_argument("--call-graph", required=True)
    parser.add_argument("--parts", nargs="+", required=True)
    parser.add_argument("--c-library", required=True)
    parser.add_argument("--size", required=True, help="the program that tells sizes of sections")
    parser.add_argument("--objects", nargs="+", required=True)
    parser.add_argument("--program", required=True)
    middle = sys.argv.index("--")
    arguments = parser.parse_args(sys.argv[1:middle])
    arguments.emulator = sys.argv[middle + 1:]

    calls, memory = measured(arguments)
    tables = [table_of_calls(calls, stacks_of(arguments)), table_of_units(calls, arguments.limit),
              table_of_long_calls(calls),
              table_of_flash(arguments.parts, text_of_archive(arguments.size, arguments.c_library)),
              table_of_memory(memory)]
    now = "\n\n".join("\n".join(table) for table in tables)
    text = arguments.document.read_text()
    begin, end = (f"<!-- {word} {arguments.machine} -->" for word in ("begin", "end"))
    head, _, rest = text.partition(begin)
    before, found, tail = rest.partition(end)
    if not found:
        sys.exit(f"cost: {arguments.document} has no marks of {arguments.machine}")
    if arguments.write:
        arguments.document.write_text(f"{head}{begin}\n\n{now}\n\n{end}{tail}")
        return
    print(now)
    faults = list(differences(before.strip().splitlines(), now.splitlines()))
    print("\n".join(f"cost: {fault}" for fault in faults) or "as the document says")
    sys.exit(1 if faults else 0)


if __name__ == "__main__":
    main()
