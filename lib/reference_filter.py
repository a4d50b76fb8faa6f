#!/usr/bin/env python3
"""A header as Doxygen reads it. Usage: reference_filter.py HEADER

The headers have plain comments. Here a comment before a declaration, or
behind one, becomes that of the declaration, the one at the head of a file that of the file; all as it
stands, with its line breaks. "// --- Memory" heads what follows, and is nobody's. Lines stay where they are.
"""

import re
import sys
from pathlib import Path

# What Doxygen would take for a command, an entity or a tag. Names of calls still become links.
ESCAPED = re.compile(r"([\\@&$#<>%\"*])")


def escaped(text):
    return ESCAPED.sub(r"\\\1", text)


def comment_of(line):
    """(what is before it, the comment) of a line; None where it has none. No string has // in it."""
    match = re.match(r"^(.*?)//(.*)$", line)
    return (match.group(1), match.group(2)) if match else None


def filtered(name, lines):
    is_head = True
    before_was_trailing = False
    for line in lines:
        found = comment_of(line)
        if not found or line.lstrip().startswith(("#", "// --- ")):
            is_head = is_head and not found and not line.strip()
            before_was_trailing = False
            yield line
            continue
        code, text = found
        # The break keeps lists and examples as they are written.
        text = (escaped(text) or " ") + ("<br>" if re.match(r"  |$", text[1:]) else "")
        if is_head:
            yield f"/// @file {name} \\ilinebr {text}"
            is_head = False
            continue
        is_trailing = bool(code.strip())
        goes_on = before_was_trailing and not is_trailing and len(code) > 12
        yield f"{code}{'///<' if is_trailing or goes_on else '///'}{text}"
        before_was_trailing = is_trailing or goes_on


def main():
    path = Path(sys.argv[1])
    parts = path.parts
    name = "/".join(parts[parts.index("include") + 1:]) if "include" in parts else path.name
    print("\n".join(filtered(name, path.read_text().splitlines())))


if __name__ == "__main__":
    main()
