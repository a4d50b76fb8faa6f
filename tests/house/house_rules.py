#!/usr/bin/env python3
"""The house rules that a program can check. Usage: house_rules.py RULE (a function below)."""

import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
ROOMS = ("lib", "port", "firmware", "tools", "tests")
SKIPPED = 77

# What the library may include of the standard library: nothing in these allocates, throws, locks
# or talks to an operating system. Of <algorithm> the parts that want a buffer would show up in the
# scan of the archive.
LIBRARY_HEADERS = {
    "algorithm", "array", "bit", "cfloat", "climits", "cmath", "compare", "concepts", "cstddef",
    "cstdint", "cstring", "limits", "new", "span", "type_traits", "utility",
    # The headers for C.
    "stdbool.h", "stddef.h", "stdint.h",
}

# Folder, and what files in it must not include (a pattern on the included path).
FORBIDDEN_ARROWS = [
    ("lib", r"^(etcm/port|port|firmware|tools|tests|modbus|posix|files|inputs)/"),
    ("port/include", r"(modbus|gpiod|microhttpd|mosquitto|openssl|systemd)"),
    ("port", r"^(firmware|tools|tests)/"),
    ("port/posix", r"^(modbus|gpiod|microhttpd|mosquitto|openssl)"),
    ("firmware", r"^(tools|tests|modbus/modbus\.h|gpiod|microhttpd|mosquitto|openssl)"),
    ("tools", r"^(firmware/(?!protocol/|profile/|fleet/)|tests)/"),
]

# Rooms: each may include those it names, and itself. A header is named with its room, so that the
# arrow shows in the line that makes it. Those of the library are drawn in its README, those of the
# gateway are the signs of its rooms.


def drawn_arrows(text):
    """Room -> the rooms to which lib/README.md draws an arrow from it."""
    drawing = text.split("## Who uses whom", 1)[1].split("```")[1]
    return {room: tuple(re.findall(r"\w+", targets or ""))
            for room, targets in re.findall(r"^(\w+)(?: *-> ((?:\w+, )*\w+))?", drawing, re.M)}


def signed_arrows(folder):
    """Room -> the rooms that its sign says it may include."""
    signs = {path.parent.name: path.read_text().split("May include", 1)[1]
             for path in folder.glob("*/README.md") if "May include" in path.read_text()}
    return {room: tuple(other for other in re.findall(r"`(\w+)`", sign) if other in signs)
            for room, sign in signs.items()}


def reachable(drawn):
    """Room -> all rooms that arrows lead to, directly or by way of others."""
    def below(room):
        found, waiting = set(), list(drawn[room])
        while waiting:
            target = waiting.pop()
            if target not in found:
                found.add(target)
                waiting.extend(drawn[target])
        return tuple(sorted(found))
    return {room: below(room) for room in drawn}


LIBRARY_ARROWS = drawn_arrows((ROOT / "lib/README.md").read_text())
LIBRARY_ROOMS = reachable(LIBRARY_ARROWS)
FIRMWARE_ARROWS = signed_arrows(ROOT / "firmware")
FIRMWARE_ROOMS = reachable(FIRMWARE_ARROWS)
# Folder, what an include of a room begins with there, and the rooms.
HOUSES = [
    ("lib/src", "", LIBRARY_ROOMS),
    ("firmware", "firmware/", FIRMWARE_ROOMS),
]

# The same for port and tools, by folder; of two the inner one counts.
FOLDERS = {
    "port/include": ("lib/include",),
    "port/src": ("port/include",),
    "port/files": ("lib/include",),
    "port/posix": ("lib/include", "port/include", "port/files"),
    "port/gpio": ("port/include", "port/posix"),
    "port/http": ("port/include", "port/posix"),
    "port/modbus": ("port/include", "port/posix"),
    "port/mqtt": ("port/include", "port/posix"),
    "port/proj": ("port/include",),
    "port/command_line": (),
    "tools/inputs": ("lib/include",),
    "tools/etcm": ("port/command_line", "lib/include", "port/files", "tools/inputs"),
    "tools/nodes": ("port/command_line", "lib/include", "port/include", "port/posix", "port/modbus",
                    "firmware/protocol"),
    "tools/bus": ("port/command_line", "port/include", "port/posix", "port/modbus", "firmware/protocol",
                  "firmware/profile"),
    "tools/bench": ("port/command_line", "lib/include", "port/files", "tools/inputs"),
    "tools/bench/fleet": ("port/command_line", "lib/include", "port/include", "port/posix", "port/mqtt",
                          "firmware/protocol", "firmware/fleet"),
    "tools/compare/systems": ("lib", "port/files", "tools/inputs"),
    # Of what uses it, a report knows what was found.
    "tools/compare/report": ("port/files", "tools/inputs", "tools/compare/systems",
                             "tools/compare/results"),
    "tools/compare": ("port/command_line", "lib/include", "port/files", "tools/inputs", "tools/bench",
                      "tools/compare/systems", "tools/compare/report"),
}
# Where an included path begins, beside the folder of its file.
INCLUDE_ROOTS = ("lib/include", "lib/src", "port/include", "port/files/include", "port", "tools", ".")


def files(*suffixes, under=ROOMS):
    """Files of the project with one of these suffixes, generated and foreign ones left out."""
    for room in under:
        start = ROOT / room
        candidates = [start] if start.is_file() else sorted(start.rglob("*"))
        for path in candidates:
            if path.is_file() and path.suffix in suffixes and "__pycache__" not in path.parts:
                yield path


def includes(path):
    for number, line in enumerate(path.read_text().splitlines(), 1):
        match = re.match(r'\s*#\s*include\s*([<"])([^>"]+)[>"]', line)
        if match:
            yield number, match.group(1) == "<", match.group(2)


def name(path):
    return path.relative_to(ROOT)


def file_length():
    """A file of the library that grows past 500 lines hides a second idea."""
    for path in files(".h", ".cpp", under=("lib",)):
        count = len(path.read_text().splitlines())
        if count > 500:
            yield f"{name(path)}: {count} lines; find the second responsibility and move it out"


def no_leftovers():
    """What is not done belongs in the tracker, not in the source."""
    # Written apart so that this file does not find itself.
    marks = re.compile(r"\b(" + "|".join(["TO" + "DO", "FIX" + "ME", "XX" + "X", "HA" + "CK"]) + r")\b")
    for path in files(".h", ".cpp", ".py", ".sh", ".cmake", ".md", ".txt", ".toml", ""):
        try:
            text = path.read_text()
        except UnicodeDecodeError:
            continue
        for number, line in enumerate(text.splitlines(), 1):
            if marks.search(line):
                yield f"{name(path)}:{number}: finish it or take it out: {line.strip()}"


def readmes():
    """Each room tells what lives in it; so does each program."""
    folders = [ROOT / room for room in ROOMS]
    folders += [path for path in (ROOT / "tools").iterdir() if path.is_dir()]
    for folder in folders:
        if any(folder.iterdir()) and not (folder / "README.md").is_file():
            yield f"{name(folder)}: has no README.md; say what lives here and what it may include"


def pragma_once():
    for path in files(".h"):
        if "#pragma once" not in path.read_text().splitlines():
            yield f"{name(path)}: has no #pragma once"


def library_includes():
    """The library includes itself and what needs neither heap nor operating system."""
    for path in files(".h", ".cpp", under=("lib/include", "lib/src")):
        for number, is_system, header in includes(path):
            if is_system and header not in LIBRARY_HEADERS:
                yield f"{name(path)}:{number}: <{header}> is not for the library"
            if not is_system and not header.startswith("etcm/"):
                if not (ROOT / "lib/src" / header).is_file():
                    yield f'{name(path)}:{number}: "{header}" is not in the library'
            public = "include" in name(path).parts
            if public and not is_system and not (ROOT / "lib/include" / header).is_file():
                yield f'{name(path)}:{number}: a public header includes "{header}", a private one'


def questions(text):
    """(position, name) of each function of a header that answers with a value which says nothing of
    being discarded. All functions of the library are noexcept; Status says it by its type."""
    blank = lambda match: re.sub(r"[^\n]", " ", match.group())
    text = re.sub(r"//.*|^ *#.*|\"[^\"\n]*\"", blank, text, flags=re.M)
    for statement in re.finditer(r"[^;{}]+", text):
        body = re.sub(r"^(\s*(public|private|protected):)?\s*", blank, statement.group())
        start = len(body) - len(body.lstrip())
        declared = re.match(r"(?:template <[^>]*>\s*)?((?:[\w:<>,&*\[\]\"]+\s+)+?)[&*]*(\w+)\(", body[start:])
        if not declared or "noexcept" not in body or "operator" in declared.group(1):
            continue
        words = set(declared.group(1).split())
        answers = words - {"constexpr", "static", "inline", "explicit", "extern", "C"}
        if answers and not words & {"using", "friend", "void", "Status", "[[nodiscard]]"}:
            yield statement.start() + start, declared.group(2)


def nodiscard():
    """Who asks the library and drops the answer has made a mistake."""
    for path in files(".h", under=("lib/include",)):
        text = path.read_text()
        for position, question in questions(text):
            number = text.count("\n", 0, position) + 1
            yield f"{name(path)}:{number}: {question}() answers and is not [[nodiscard]]"


def nodiscard_is_watched():
    """The rule above would see a question without the word, and only that."""
    planted = ("class A {\n public:\n  A() noexcept;\n  void tell() noexcept;\n"
               "  Status change() noexcept;\n  [[nodiscard]] int told() const noexcept;\n"
               "  const int& planted(int a,\n    int b) const noexcept { return a; }\n};\n"
               "template <class T>\nconstexpr T* sown(T t) noexcept;\n")
    seen = [question for _, question in questions(planted)]
    if seen != ["planted", "sown"]:
        yield f"questions(): sees {seen}"


def width_in_names():
    """What a program sees of the library carries the width of ids in its name (etcm/id_width.h)."""
    for path in files(".h", under=("lib/include",)):
        if re.search(r"^namespace etcm \{\n(?!inline namespace ETCM_IDS \{)", path.read_text(), re.M):
            yield f"{name(path)}: has no: inline namespace ETCM_IDS {{"


def installed_headers():
    """Every public header is among those that are installed."""
    listed = (ROOT / "lib/CMakeLists.txt").read_text()
    for path in files(".h", under=("lib/include",)):
        header = path.relative_to(ROOT / "lib").as_posix()
        if f"\n  {header}\n" not in listed:
            yield f"{name(path)}: is in no list of lib/CMakeLists.txt, so it is not installed"


def arrows():
    """The arrow graph of the rooms (tests/README.md) as far as includes show it."""
    for folder, pattern in FORBIDDEN_ARROWS:
        for path in files(".h", ".cpp", under=(folder,)):
            for number, _, header in includes(path):
                if re.search(pattern, header):
                    yield f"{name(path)}:{number}: {folder} must not include {header}"


def rooms(root=ROOT):
    """Inside lib/src and firmware every file is in a room, and includes go down."""
    for folder, prefix, allowed in HOUSES:
        for path in sorted((root / folder).rglob("*")):
            if path.suffix not in (".h", ".cpp"):
                continue
            place = path.relative_to(root)
            room = path.relative_to(root / folder).parts[0]
            if room not in allowed:
                yield f"{place}: is in no room of {folder}; its rooms are {', '.join(allowed)}"
                continue
            for number, is_system, header in includes(path):
                if is_system or not header.startswith(prefix):
                    beside = (path.parent / header).is_file()
                    if not is_system and beside:
                        yield f'{place}:{number}: "{header}" needs its room: "{prefix}{room}/{header}"'
                    continue
                other = header[len(prefix):].split("/")[0]
                if other in allowed and other != room and other not in allowed[room]:
                    yield f"{place}:{number}: {room} must not include {other}; it may include " + (
                        ", ".join(allowed[room]) or "no other room")


def begins_with(path, folder):
    return path == folder or path.startswith((folder + "/", folder + "."))


def included_path(root, path, header):
    """Where the header of a quoted include is; None where it is not the project's."""
    for folder in (path.parent, *(root / folder for folder in INCLUDE_ROOTS)):
        if (folder / header).is_file():
            return (folder / header).resolve().relative_to(root.resolve()).as_posix()
    return None


def folders(root=ROOT):
    """Every source of port and tools is in a folder with arrows, and keeps to them."""
    for path in sorted([*(root / "port").rglob("*"), *(root / "tools").rglob("*")]):
        if path.suffix not in (".h", ".cpp"):
            continue
        here = path.relative_to(root).as_posix()
        own = max((key for key in FOLDERS if begins_with(here, key)), key=len, default=None)
        if own is None:
            yield f"{here}: its folder has no arrows; say in FOLDERS what it may include"
            continue
        for number, _, header in includes(path):
            target = included_path(root, path, header)
            if target is None:
                continue
            other = max((key for key in FOLDERS if begins_with(target, key)), key=len, default="")
            if other != own and not any(begins_with(target, key) and len(key) >= len(other)
                                        for key in FOLDERS[own]):
                yield f"{here}:{number}: {own} must not include {target}; it may include " + (
                    ", ".join(FOLDERS[own]))


def rooms_are_watched():
    """The rules above would see an include that goes up, one without a room, and a stray file."""
    with tempfile.TemporaryDirectory() as folder:
        root = Path(folder)
        planted = {
            "lib/src/topology/planted.cpp": '#include "geometry/predicates_inline.h"\n',
            "firmware/records/planted.cpp": '#include "firmware/mesh/node_placement.h"\n',
            "firmware/polling/beside.h": "",
            "firmware/polling/planted.cpp": '#include "beside.h"\n',
            "firmware/stray.cpp": "",
            "firmware/mesh/good.cpp": '#include "firmware/records/node_table.h"\n',
            "port/modbus/up.h": "",
            "port/posix/planted.cpp": '#include "modbus/up.h"\n',
            "port/serial/planted.cpp": "",
            "port/modbus/good.cpp": '#include "modbus/up.h"\n',
            "tools/compare/results.h": "",
            "tools/compare/experiment.h": "",
            "tools/compare/report/planted.cpp": '#include "compare/experiment.h"\n',
            "tools/compare/report/good.cpp": '#include "compare/results.h"\n',
            "tools/inputs/planted.cpp": '#include "../compare/results.h"\n',
        }
        for name_, text in planted.items():
            (root / name_).parent.mkdir(parents=True, exist_ok=True)
            (root / name_).write_text(text)
        seen = {complaint.split(":")[0] for complaint in [*rooms(root), *folders(root)]}
    for name_ in planted:
        should = "planted" in name_ or "stray" in name_
        if should != (name_ in seen):
            yield f"the arrows: {'misses' if should else 'complains of'} {name_}"


def library_arrows(drawn=None):
    """The arrows drawn in lib/README.md are those of the includes in lib/src, and of the signs."""
    drawn = LIBRARY_ARROWS if drawn is None else drawn
    start = ROOT / "lib/src"
    for room in sorted({path.name for path in start.iterdir() if path.is_dir()} ^ set(drawn)):
        yield f"{room}: is a folder of lib/src or in the drawing of lib/README.md, not both"
        return
    allowed, walked = reachable(drawn), set()
    for path in files(".h", ".cpp", under=("lib/src",)):
        room = path.relative_to(start).parts[0]
        for number, is_system, header in includes(path):
            other = header.split("/")[0]
            if is_system or other not in drawn or other == room:
                continue
            walked.add((room, other))
            if other not in allowed[room]:
                yield f"{name(path)}:{number}: lib/README.md draws no arrows from {room} to {other}"
    for room, targets in drawn.items():
        for target in targets:
            if (room, target) not in walked:
                yield f"lib/README.md: draws {room} -> {target}, and nothing there includes it"
        sign = (start / room / "README.md").read_text().split("May include", 1)[1]
        named = set(re.findall(r"`(\w+)`", sign))
        if not set(targets) <= named <= set(allowed[room]):
            yield f"lib/src/{room}/README.md: does not say what lib/README.md draws"


def library_arrows_are_watched():
    """The rule above would see an arrow too many and one too few."""
    more = {**LIBRARY_ARROWS, "topology": ("base", "geometry")}
    fewer = {**LIBRARY_ARROWS, "triangulation": ("topology",)}
    for title, drawn, expected in (
            ("an arrow too many", more, "draws topology -> geometry, and nothing there includes it"),
            ("an arrow too few", fewer, "draws no arrows from triangulation to geometry")):
        if not any(expected in complaint for complaint in library_arrows(drawn)):
            yield f"library_arrows(): misses {title}"


def firmware_signs():
    """firmware/README.md has the rooms from the top down, and each sign names what is included."""
    overview = (ROOT / "firmware/README.md").read_text()
    order = re.findall(r"^\| \[(\w+)\]", overview, re.M)
    if set(order) != set(FIRMWARE_ARROWS):
        yield ("firmware/README.md: names other rooms than have signs that say what they may include: "
               f"{', '.join(sorted(set(order) ^ set(FIRMWARE_ARROWS)))}")
        return
    walked = set()
    for path in files(".h", ".cpp", under=("firmware",)):
        room = path.relative_to(ROOT / "firmware").parts[0]
        walked.update((room, header.split("/")[1]) for _, _, header in includes(path)
                      if header.startswith("firmware/"))
    for room, targets in FIRMWARE_ARROWS.items():
        for target in targets:
            if order.index(target) < order.index(room):
                yield f"firmware/README.md: {room} stands below {target}, which it may include"
            if (room, target) not in walked:
                yield f"firmware/{room}/README.md: names {target}, which nothing there includes"


def room_signs():
    """Each room has a sign at its door."""
    for folder, _, allowed in HOUSES:
        for room in allowed:
            if not (ROOT / folder / room / "README.md").is_file():
                yield f"{folder}/{room}: has no README.md; say what lives here and what it may include"


def crowded_folders():
    """A folder with more than 25 sources wants rooms."""
    for top in ("lib", "port", "firmware", "tools"):
        counts = {}
        for path in files(".cpp", ".h", under=(top,)):
            # A header and its source are one.
            counts.setdefault(path.parent, set()).add(path.stem)
        for folder, stems in counts.items():
            if len(stems) > 25:
                yield f"{name(folder)}: {len(stems)} sources; find the rooms in it"


def version():
    """Header and build tell one version."""
    build = re.search(r"VERSION (\d+)\.(\d+)\.(\d+)", (ROOT / "CMakeLists.txt").read_text().split("project(", 1)[1])
    header = (ROOT / "lib/include/etcm/version.h").read_text()
    told = re.findall(r"#define ETCM_VERSION_(?:MAJOR|MINOR|PATCH) (\d+)", header)
    text = re.search(r'#define ETCM_VERSION_STRING "(.*)"', header).group(1)
    if list(build.groups()) != told or text != ".".join(told):
        yield f"lib/include/etcm/version.h: tells {told} and '{text}', CMakeLists.txt {build.groups()}"


def readme_example():
    """The example in README.md is the one that is compiled and run."""
    example = (ROOT / "tests/install/outside/example.cpp").read_text()
    if "```cpp\n" + example + "```" not in (ROOT / "README.md").read_text():
        yield "README.md: its C++ example differs from tests/install/outside/example.cpp; copy it over"


def without_code(path):
    return re.sub(r"```.*?```", "", path.read_text(), flags=re.S)


def headings(path):
    """What a link to a heading of the document has behind its #."""
    return {re.sub(r"[^a-z0-9 _-]", "", line.lower()).strip().replace(" ", "-")
            for line in re.findall(r"^#+ (.*)$", without_code(path), re.M)}


def links():
    """Relative links in the documents lead to files, and to headings that are in them."""
    for path in [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *files(".md")]:
        for target, heading in re.findall(r"\]\(([^)#\s]*)(?:#([^)]*))?\)", without_code(path)):
            if "://" in target:
                continue
            other = path.parent / target if target else path
            if not other.exists():
                yield f"{name(path)}: links to {target}, which does not exist"
            elif heading and heading not in headings(other):
                yield f"{name(path)}: links to {target}#{heading}, a heading that does not exist"


def format():
    """clang-format has nothing to say. Skipped without Debian 12's: each version has its own taste."""
    tool = shutil.which("clang-format-14") or shutil.which("clang-format")
    version = subprocess.run([tool, "--version"], capture_output=True, text=True).stdout if tool else ""
    if "version 14." not in version:
        print("clang-format 14 is not installed; skipped")
        sys.exit(SKIPPED)
    paths = list(files(".h", ".cpp", ".c"))
    result = subprocess.run([tool, "--dry-run", "-Werror", *map(str, paths)], capture_output=True,
                            text=True)
    complaints = [line for line in result.stderr.splitlines() if "error:" in line]
    for path in paths:
        if any(line.startswith(f"{path}:") for line in complaints):
            yield f"{name(path)}: not formatted; run: clang-format -i {name(path)}"
    if result.returncode != 0 and not complaints:
        yield f"clang-format failed: {result.stderr.strip()}"


RULES = [file_length, no_leftovers, readmes, pragma_once, library_includes, nodiscard,
         nodiscard_is_watched, width_in_names, installed_headers, arrows, rooms, folders,
         rooms_are_watched, library_arrows, library_arrows_are_watched, firmware_signs, room_signs, crowded_folders, version, readme_example, links, format]


def main():
    rules = {rule.__name__: rule for rule in RULES}
    if len(sys.argv) != 2 or sys.argv[1] not in rules:
        sys.exit(f"usage: house_rules.py {'|'.join(rules)}")
    broken = list(rules[sys.argv[1]]())
    print("\n".join(broken) if broken else "kept")
    sys.exit(1 if broken else 0)


if __name__ == "__main__":
    main()
