#!/usr/bin/env python3
"""The deepest stack of every public call, and the proof that nothing recurses.

Usage: call_graph.py --limit BYTES [--promises FOLDER] [--show COUNT] FILE.o...

Reads the call graphs that GCC's -fcallgraph-info=su leaves beside each object file (FILE.ci). Calls
through a pointer are in them without a target; INDIRECT below says where each may lead. Fails on a
cycle, on a frame of unknown size, on a call through a pointer that is not listed, and on a public
call above the limit, or above what the header in FOLDER promises of it.
"""

import argparse
import re
import sys
from pathlib import Path

# Source of the call, and a pattern of the functions it may lead to; None: to the caller's alone.
# What a caller's own function needs comes on top of ours: the caller knows it.
INDIRECT = {
    "build.cpp": None,
    "work_meter.cpp": None,
    "pulse.cpp": None,
    "audit.cpp": r"^etcm::Audit etcm::\{anonymous\}::Auditor::\w+\(\)$",
    "influence.cpp": r"^void etcm::internal::\{anonymous\}::on_\w+\(",
    "conform.cpp": r"^etcm::Parameter etcm::(\w+\(const SplitSite&\)|.*::stray\(.*)$",
}
# Bytes for a function of the compiler's or C's run-time: memset, memcpy, division and the soft
# floating point of machines without a unit for it. More than any of them takes.
RUNTIME_BYTES = 128
# Ends the program; where it leads is the program's choice.
FINAL = {"etcm_check_failed", "etcm_illegal_argument"}

NODE = re.compile(r'^node: \{ title: "([^"]+)" label: "([^"]*)"( shape : ellipse)?')
EDGE = re.compile(r'^edge: \{ sourcename: "([^"]+)" targetname: "([^"]+)"(?: label: "([^"]*)")?')


class Function:
    def __init__(self, name, source):
        self.name = name
        self.source = source
        self.frame = None
        self.is_dynamic = False
        self.calls = set()


def fail(text):
    sys.exit(f"call_graph: {text}")


def read(paths):
    functions, pointers = {}, []
    for path in paths:
        if not path.is_file():
            fail(f"{path} is missing; compile with GCC and -fcallgraph-info=su")
        # What an inline function or an anonymous namespace defines is of one file alone.
        lines = path.read_text().splitlines()
        for line in lines:
            if match := NODE.match(line):
                title, label, is_foreign = match.groups()
                parts = label.split("\\n")
                # Newer compilers print types that older ones shorten.
                signature = re.sub(r"\bids_(16|32)::", "", parts[0])
                signature = signature.replace("etcm::internal::MeshState&", "MeshState&")
                signature = signature.replace("etcm::internal::SegmentId", "SegmentId")
                function = functions.setdefault(title, Function(signature, parts[1] if parts[1:] else ""))
                if is_foreign:
                    continue
                function.name = signature
                frame = next((part for part in parts if " bytes (" in part), None)
                if frame:
                    # A function that is compiled into several objects: the greatest of its frames.
                    function.frame = max(function.frame or 0, int(frame.split()[0]))
                    function.is_dynamic |= "(dynamic)" in frame
        for line in lines:
            if match := EDGE.match(line):
                caller, callee, place = match.groups()
                if callee == "__indirect_call":
                    pointers.append((caller, place or ""))
                else:
                    functions[caller].calls.add(callee)
    return functions, pointers


def add_pointer_calls(functions, pointers):
    for caller, place in pointers:
        source = Path(place.split(":")[0]).name
        if source not in INDIRECT:
            fail(f"{place}: calls through a pointer; say in INDIRECT where that may lead")
        if INDIRECT[source] is None:
            continue
        targets = [title for title, function in functions.items()
                   if function.frame is not None and re.search(INDIRECT[source], function.name)]
        if not targets:
            fail(f"{place}: nothing matches its pattern in INDIRECT; bring that up to date")
        functions[caller].calls.update(targets)


def deepest(functions):
    """Bytes and path of the deepest descent from each function, callees first."""
    depth, running = {}, []

    def visit(title):
        if title in depth:
            return depth[title]
        if title in running:
            names = [functions[t].name for t in running[running.index(title):] + [title]]
            fail("recursion:\n  " + "\n  ".join(names))
        function = functions.get(title)
        if title in FINAL:
            depth[title] = (0, [])
            return depth[title]
        if function is None or function.frame is None:
            # A constructor of whole objects may be another name of that of bases.
            of_bases = title.replace("C1E", "C2E", 1)
            if of_bases != title and of_bases in functions:
                depth[title] = visit(of_bases)
                return depth[title]
            if "etcm" in title:
                fail(f"{title}: its object file is not among those given")
            depth[title] = (RUNTIME_BYTES, [title])
            return depth[title]
        if function.is_dynamic:
            fail(f"{function.name}: its frame grows with the data")
        if title in function.calls:
            fail(f"{function.name}: calls itself")
        running.append(title)
        others = sorted(function.calls)
        below, path = max((visit(callee) for callee in others), default=(0, []))
        running.pop()
        depth[title] = (function.frame + below, [title] + path)
        return depth[title]

    for title in functions:
        visit(title)
    return depth


def is_public(title, function):
    """Not static (those have their file before the name), nor in the inner namespace."""
    return function.frame is not None and re.match(r"_ZNK?4etcm(?!8internal)", title) is not None


def promises(folder):
    """Name of a function -> bytes, where its header says "less than ... of stack" of it, or at its head
    of all that it declares."""
    def functions_in(text):
        return re.findall(r"\b(\w+)\((?:const )?Mesh& ", text)

    found = {}
    for path in sorted(folder.glob("*.h")):
        head, _, body = re.sub(r"\n *// ?", " ", path.read_text()).partition("#pragma once")
        for part in (head, body):
            for match in re.finditer(r"less than ([\d.]+) (KiB|bytes) of stack", part):
                size = float(match[1]) * (1024 if match[2] == "KiB" else 1)
                names = functions_in(body) if part is head else functions_in(body[match.end():])[:1]
                found.update((name, size) for name in names)
    return found


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--limit", type=int, required=True, help="bytes that a public call may take")
    parser.add_argument("--promises", type=Path, help="the folder of the headers")
    parser.add_argument("--show", type=int, default=12, help="how many public calls to list")
    parser.add_argument("objects", nargs="+", type=Path)
    arguments = parser.parse_args()

    functions, pointers = read([path.with_suffix(".ci") for path in arguments.objects])
    add_pointer_calls(functions, pointers)
    depth = deepest(functions)

    calls = sorted(((depth[title], title) for title, f in functions.items() if is_public(title, f)),
                   key=lambda entry: -entry[0][0])
    if not calls:
        fail("no public call found; are these the library's objects?")
    print(f"bytes  public call ({len(calls)} in all; no recursion)")
    for (size, _), title in calls[:arguments.show]:
        print(f"{size:5}  {functions[title].name}")
    promised, held = promises(arguments.promises) if arguments.promises else {}, {}
    for (size, _), title in calls:
        match = re.search(r"::(\w+)\(", functions[title].name)
        if match and match[1] in promised:
            held[match[1]] = max(size, held.get(match[1], 0))
    print("promised and taken: " + ", ".join(f"{name} {promised[name]:.0f}, {size}"
                                             for name, size in sorted(held.items())))
    if missing := promised.keys() - held.keys():
        fail(f"no such public call: {', '.join(sorted(missing))}")
    if broken := [name for name, size in held.items() if size >= promised[name]]:
        fail(f"more than the header says: {', '.join(sorted(broken))}")
    size, path = calls[0][0]
    print("the deepest descent:")
    for title in path:
        function = functions.get(title)
        own = function.frame if function and function.frame is not None else RUNTIME_BYTES
        print(f"{own:5}  {function.name if function else title}")
    print(f"the deepest public call: {size} bytes, limit {arguments.limit}")
    sys.exit(1 if size > arguments.limit else 0)


if __name__ == "__main__":
    main()
