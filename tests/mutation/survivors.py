"""What survivors.txt explains."""


class Explained:
    """Blocks between empty lines: a file, lines as they are (-) with what is planted there (+), and why."""

    def __init__(self, path):
        self.reasons = {}
        for block in path.read_text().split("\n\n"):
            lines = [line for line in block.splitlines() if not line.startswith("#")]
            if lines:
                self.take(lines, path.name)

    def take(self, lines, name):
        file, rest = lines[0], lines[1:]
        pairs = [line for line in rest if line[:2] in ("- ", "+ ")]
        why = " ".join(line for line in rest if line[:2] not in ("- ", "+ "))
        if not why or len(pairs) % 2 != 0:
            raise SystemExit(f"{name}: {file}: a block is pairs of - and +, and why they are harmless")
        for before, after in zip(pairs[::2], pairs[1::2]):
            self.reasons[file, before[2:], after[2:]] = why

    def has(self, change):
        return (change.file, change.before.strip(), change.after.strip()) in self.reasons
