#!/usr/bin/env python3
"""Each call that answers a status names its errors in its header. Usage: error_lists.py [plant]

Compares what the comments of lib/include/etcm/*.h and lib/include/etcm/c/*.h name with the tables of
lib/docs/answers.md, which property/Calls holds to what is answered. plant: shows that an error that is
left out would be seen, and one that cannot come.
"""

import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
HEADERS = ROOT / "lib/include/etcm"

# Calls of C whose name in answers.md is another one.
C_NAMES = {"build_measured": "build",
           "handles_find_node": "Handles::find(NodeHandle)",
           "handles_find_feature": "Handles::find(FeatureHandle)",
           "handles_of_node": "Handles::handle_of(VertexId)",
           "handles_of_feature": "Handles::handle_of(FeatureId)"}
OVERLOADED = ("Handles::find", "Handles::handle_of")

ROOM_AND_BOUNDS = {"out_of_vertices", "out_of_features", "steiner_budget", "work_limit", "grid_exhausted"}
OF_NO_INPUT = {"steiner_budget", "work_limit", "grid_exhausted"}
UNKNOWN = {"unknown_vertex", "unknown_feature"}


def tables():
    """The errors of each call, by its name in answers.md."""
    errors, calls = {}, []
    for line in (ROOT / "lib/docs/answers.md").read_text().splitlines():
        if line.startswith("## "):
            calls = line[3:].split(", ")
        elif row := re.match(r"\| ([a-z_]+) \| [a-z] \|", line):
            for call in calls:
                errors.setdefault(call, set()).add(row[1])
    return {call: some - {"ok"} for call, some in errors.items()}


def declarations(text, is_c):
    """(name in answers.md, arguments, the comment above) of each call that answers a status."""
    owner, comment, was_comment, is_public, lines = "", "", False, True, text.splitlines()
    for at, line in enumerate(lines):
        said = re.match(r" *// ?(.*)", line)
        if said:
            comment = f"{comment} {said[1]}" if was_comment else said[1]
        was_comment = bool(said)
        if opened := re.match(r"class (\w+) \{", line):
            owner = opened[1]
        if line in (" private:", "};"):
            is_public, owner = line == "};", ""
        declared = re.match(r"ETCM_MUST_USE etcm_status_t etcm_(\w+)\(" if is_c else r" *Status (\w+)\(", line)
        if not declared or not is_public:
            continue
        name = declared[1]
        arguments = re.search(r"\((.*?)\)(?: const)?(?: noexcept)?;", " ".join(lines[at:at + 9]))[1]
        if is_c:
            name = C_NAMES.get(name) or \
                re.sub("^reader_", "MeshReader::", re.sub("^handles_", "Handles::", name))
        elif owner not in ("", "Mesh"):
            name = f"{owner}::{name}"
            name += f"({arguments.split()[0]})" if name in OVERLOADED else ""
        yield name, arguments, comment


class Errors:
    """Those of all calls of the headers, in C or in C++, as their comments name them."""

    def __init__(self, texts, is_c, statuses):
        self.statuses, self.comments, self.arguments, self.attaching = statuses, {}, {}, set()
        for text in texts:
            if is_c:
                text = re.sub(r"\betcm_(\w+)\(\)", r"\1()", text)
                text = re.sub(r"\bETCM_([A-Z_]+)\b", lambda word: word[1].lower()
                              if word[1].lower() in statuses else word[0], text)
            if list_of_attaching := re.search(r"\n// The errors of all.*?#pragma once", text, re.S):
                self.attaching = self.words(list_of_attaching[0])
            for name, arguments, comment in declarations(text, is_c):
                if not comment.startswith("The same, and") or name not in self.comments:
                    self.comments[name], self.arguments[name] = comment, arguments

    def words(self, text):
        return set(re.findall(r"[a-z_]+", text)) & self.statuses

    def of_comment(self, name):
        """What the call's own comment names, other calls' errors among it."""
        text = self.comments[name].split("Errors:")[-1]
        errors = self.words(text)
        if re.search("room.and.bounds", text):
            errors |= ROOM_AND_BOUNDS
        for other, which in re.findall(r"those of (\w+)\(\)( for its input)?", text):
            errors |= self.of_comment(other) - (OF_NO_INPUT if which else set())
        return errors - set(re.findall(r"\bbut (\w+)", text))

    def of(self, name):
        """And what the headers say of all calls of its kind."""
        arguments, method = self.arguments[name], name.split("::")[-1]
        if method in ("attach", "attach_copy"):
            takes_policy = re.search("policy", arguments, re.I)
            return self.attaching | {"bad_config"} if takes_policy else self.attaching - {"bad_config"}
        if name.startswith("Handles::") and "limit" in arguments:
            errors = self.of(method) - UNKNOWN
            errors |= {"stale_handle"} if re.search(r"(Handle|_handle_t) \w", arguments) else set()
            return errors | ({"out_of_handles"} if re.search(r"(Handle&|_handle_t\*) \w", arguments) else set())
        errors = self.of_comment(name)
        if "handle_of" in name:
            errors -= {"unknown_feature" if "Vertex" in name else "unknown_vertex"}
        if "limit" in arguments and "mesh_not_empty" not in errors:
            errors.add("mesh_unresolved")
        return errors


def complaints(texts, is_c, promised):
    errors = Errors(texts, is_c, set().union(*promised.values()))
    for name in errors.comments:
        named, right = errors.of(name), promised.get(name, set())
        where = f"{name}() in {'C' if is_c else 'C++'}"
        if right - named:
            yield f"{where}: its header does not name {', '.join(sorted(right - named))}"
        if named - right:
            yield f"{where}: its header names {', '.join(sorted(named - right))}, which never comes"
    for name in promised.keys() - errors.comments.keys():
        yield f"{name}: has a table in answers.md, and no header"


def main():
    promised = tables()
    cpp = [path.read_text() for path in sorted(HEADERS.glob("*.h"))]
    c = [path.read_text() for path in sorted((HEADERS / "c").glob("*.h"))]
    if sys.argv[1:] == ["plant"]:
        cpp = [text.replace("unknown_feature, work_limit", "unknown_feature") for text in cpp]
        c = [text.replace("Errors: ETCM_STALE_HANDLE.", "Errors: ETCM_STALE_HANDLE, ETCM_DAMAGED.") for text in c]
    found = list(complaints(cpp, False, promised)) + list(complaints(c, True, promised))
    if sys.argv[1:] == ["plant"]:
        seen = sorted(line.split(" in ")[0] for line in found)
        sys.exit(0 if seen == ["Handles::find(FeatureHandle)()", "Handles::find(NodeHandle)()",
                               "Handles::remove_feature()", "remove_feature()"] else f"sees {seen}")
    print("\n".join(found) or f"the headers name the errors of each of {len(promised)} calls")
    sys.exit(1 if found or len(promised) < 20 else 0)


if __name__ == "__main__":
    main()
