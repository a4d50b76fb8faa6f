#!/usr/bin/env python3
"""Every call of the C++ headers has its call for C. Usage: c_interface.py [plant]

Compares the functions that lib/include/etcm/*.h declare with those of lib/include/etcm/c/*.h, and the
statuses of both. plant: shows that a call without one would be seen.
"""

import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
HEADERS = ROOT / "lib/include/etcm"

# What a class is called in the names of C.
CLASSES = {"": "", "Mesh": "", "Handles": "handles_", "DryRun": "dry_run_",
           "Surroundings": "surroundings_", "SplitSite": "split_site_",
           "MeshReader": "reader_"}

# Where the name in C is another one, or there are several: overloads have names of their own.
OTHER_NAMES = {
    "find": ["etcm_handles_find_node", "etcm_handles_find_feature"],
    "handle_of": ["etcm_handles_of_node", "etcm_handles_of_feature"],
    "to_string": ["etcm_status_name", "etcm_call_name", "etcm_fault_name", "etcm_rule_name"],
    "words": ["ETCM_HANDLES_WORDS"],
    "hint_side_bits": ["ETCM_HINT_CELLS"],
    "unlimited": ["ETCM_UNLIMITED"],
    "none": ["ETCM_NONE"],
    "bytes": ["ETCM_STORAGE"],
    "Surroundings": ["etcm_surroundings_open"],
}
# What C programs do without, and why.
WITHOUT = {
    "is_none": "an id is compared with ETCM_NONE",
    "is_ghost": "a corner is compared with ETCM_INFINITE",
    "Id": "ids are integers",
    "DryRun": "a dry run is one call",
    "Handles": "all zero",
    "Mesh": "all zero",
    "MeshReader": "all zero",
    "storage_bytes_as": "for tools that ask for other machines",
    "storage_bytes_with": "for tools that ask for other machines",
    "etcm_illegal_argument": "is C already",
}
# Of these C has ids that are integers, ETCM_STORAGE() and the calls that visit.
CLASSES_WITHOUT = {"Id", "MeshStorage", "MeshRange", "Iterator", "NodePlaces", "FeaturePlaces", "EdgePlaces"}


def functions(text):
    """(class, name) of what a header declares publicly."""
    text = re.sub(r"//.*|^ *#(?:[^\n\\]|\\\n|\\.)*", "", text, flags=re.M)
    text = re.sub(r"\bprivate:.*?(?=\n};)", "", text, flags=re.S)
    text = re.sub(r"\[\[\w+\]\]\s*|\bnoexcept\b", " ", text)
    classes, depth, at = [], 0, 0
    for match in re.finditer(r"[{};]", text):
        statement, mark = text[at:match.start()], match.group()
        at = match.end()
        statement = re.sub(r"^\s*(public:|: *\w+\([^)]*\))", "", statement)
        opened = re.match(r"\s*(?:template <[^>]*>\s*)?(?:class|struct)\s+(\w+)\s*$", statement)
        declared = re.match(r"\s*(?:template <[^>]*>\s*)?((?:[\w:<>,&*]+\s+[&*]*)*)(\w+)\(", statement)
        in_body = any(kind == "body" for kind, _ in classes)
        if declared and not in_body and "operator" not in statement and "using" not in statement \
                and not declared.group(1).startswith("friend"):
            owner = next((name for kind, name in reversed(classes) if kind == "class"), "")
            yield owner, declared.group(2)
        if mark == "{":
            kind = ("class", opened.group(1)) if opened else \
                ("namespace", "") if re.search(r"\bnamespace\b", statement) else ("body", "")
            classes.append(kind)
        elif mark == "}" and classes:
            classes.pop()


def c_names():
    text = "".join(path.read_text() for path in sorted((HEADERS / "c").glob("*.h")))
    text = re.sub(r"//.*", "", text)
    return set(re.findall(r"\b(etcm_\w+)\(", text)) | set(re.findall(r"#define (ETCM_\w+)", text)), text


def complaints(texts):
    known, c_text = c_names()
    for path, text in texts:
        for owner, name in functions(text):
            if name in WITHOUT or owner in CLASSES_WITHOUT and name not in OTHER_NAMES:
                continue
            wanted = OTHER_NAMES.get(name) or ["etcm_" + CLASSES.get(owner, "") + name]
            for c_name in wanted:
                if c_name not in known:
                    yield f"{path}: {owner}::{name}() has no {c_name} in lib/include/etcm/c; add it"
    status = (HEADERS / "status.h").read_text()
    same = (ROOT / "lib/src/c/texts.cpp").read_text()
    for name, number in re.findall(r"^ +(\w+) = (\d+),", status, re.M):
        if not re.search(rf"\bETCM_{name.upper()} = {number}\b", c_text):
            yield f"status.h: {name} is no ETCM_{name.upper()} = {number} in c/types.h"
        if f"ETCM_SAME_STATUS(ETCM_{name.upper()}, {name});" not in same:
            yield f"status.h: {name} is not held equal in lib/src/c/texts.cpp"


def main():
    texts = [(f"etcm/{path.name}", path.read_text()) for path in sorted(HEADERS.glob("*.h"))
             if path.name != "etcm.h"]
    if sys.argv[1:] == ["plant"]:
        planted = ("namespace etcm {\nclass Mesh {\n public:\n  Status planted(int a) noexcept;\n"
                   " private:\n  int hidden() noexcept;\n};\nint sown(int a,\n  int b) noexcept;\n}\n")
        seen = [line.split("::")[1].split("(")[0] for line in complaints([("planted.h", planted)])]
        sys.exit(0 if seen == ["planted", "sown"] else f"sees {seen}")
    count = sum(1 for _, text in texts for _ in functions(text))
    found = list(complaints(texts))
    print("\n".join(found) or f"each of {count} declarations has its call for C, or a reason")
    # A parser that finds nothing complains of nothing.
    sys.exit(1 if found or count < 100 else 0)


if __name__ == "__main__":
    main()
