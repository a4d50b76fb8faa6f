#!/usr/bin/env python3
"""Plants small changes into sources, one at a time: the tests beside each group must catch them.

Usage: mutate.py [GROUP...] [--sample N] [--seed S] [--file F [--line L]] [--list]

GROUP is one of those of groups.py; without one, all. Works on a copy of the tree in build/mutation, which it
makes and builds first. A change that does not compile is none. One that lets a test fail, crash or
hang is caught. What survives is printed, but for what survivors.txt explains.
"""

import argparse
import os
import random
import resource
import shutil
import signal
import subprocess
import sys
import time
from dataclasses import dataclass
from pathlib import Path

from changes import changes_of
from groups import GROUPS
from survivors import Explained

ROOT = Path(__file__).resolve().parents[2]
WORK = ROOT / "build/mutation"
COPIED = ("CMakeLists.txt", "lib", "port", "firmware", "tools", "tests")
CONFIGURE = (
    "-GNinja", "-DCMAKE_BUILD_TYPE=Release", "-DCMAKE_CXX_FLAGS_RELEASE=-O1 -DNDEBUG -D_GLIBCXX_ASSERTIONS",
    "-DCMAKE_EXE_LINKER_FLAGS=-fuse-ld=lld", "-DETCM_BUILD_BENCH=OFF", "-DETCM_INSTALL=OFF",
    # A change may make a comparison that is always true.
    "-DCMAKE_COMPILE_WARNING_AS_ERROR=OFF",
)
# A test may take so many times as long as it does on the sound sources, and so many seconds more. The time of
# the processor tells what turns round and round, whatever else the machine does; the other what waits.
CPU_PATIENCE = (4, 3.0)
WAIT_PATIENCE = (20, 30.0)


@dataclass(frozen=True)
class Patience:
    cpu: int
    wait: float


def cpu_of_children():
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


class Tree:
    """A copy of the sources, and a build of it."""

    def __init__(self, work):
        self.source, self.build = work / "source", work / "build"

    def refresh(self):
        """Copies what differs, so that little is built anew."""
        said = subprocess.run(["git", "-C", str(ROOT), "ls-files", "-co", "--exclude-standard", *COPIED],
                              capture_output=True, text=True, check=True).stdout.splitlines()
        for name in said:
            ours, copy = ROOT / name, self.source / name
            if not ours.is_file() or (copy.is_file() and copy.read_bytes() == ours.read_bytes()):
                continue
            copy.parent.mkdir(parents=True, exist_ok=True)
            copy.write_bytes(ours.read_bytes())
            shutil.copymode(ours, copy)
        if not (self.build / "build.ninja").is_file():
            subprocess.run(["cmake", "-S", self.source, "-B", self.build, *CONFIGURE], check=True,
                           stdout=subprocess.DEVNULL)

    def make(self, *targets):
        environment = dict(os.environ, CCACHE_DISABLE="1")
        return subprocess.run(["ninja", "-C", self.build, "-j1", *targets], capture_output=True, text=True,
                              env=environment)

    def run(self, test, patience):
        """What is wrong, or None."""
        program, *arguments = test.split()
        environment = dict(os.environ, GTEST_FAIL_FAST="1", GTEST_BRIEF="1")

        def limit():
            resource.setrlimit(resource.RLIMIT_CPU, (patience.cpu, patience.cpu))
            resource.setrlimit(resource.RLIMIT_CORE, (0, 0))

        try:
            result = subprocess.run([self.build / "tests/bin" / program, *arguments], cwd=self.build,
                                    env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                                    timeout=patience.wait, preexec_fn=limit)
        except subprocess.TimeoutExpired:
            return f"{program} hangs"
        if result.returncode in (-signal.SIGKILL, -signal.SIGXCPU):
            return f"{program} takes far longer"
        return f"{program} ends with {result.returncode}" if result.returncode != 0 else None


class Judge:
    """The tests of a group, and how long each takes on the sound sources."""

    def __init__(self, tree, tests):
        self.tree, self.tests, self.patience = tree, tests, {}
        for test in tests:
            made = tree.make(test.split()[0])
            if made.returncode != 0:
                sys.exit(f"mutate: the sound {test.split()[0]} does not build:\n{made.stdout[-2000:]}")
            started, cpu = time.monotonic(), cpu_of_children()
            wrong = tree.run(test, Patience(cpu=600, wait=600))
            if wrong:
                sys.exit(f"mutate: without any change {wrong} ({test}); mend that first")
            cpu, waited = cpu_of_children() - cpu, time.monotonic() - started
            self.patience[test] = Patience(cpu=round(CPU_PATIENCE[0] * cpu + CPU_PATIENCE[1]),
                                           wait=WAIT_PATIENCE[0] * waited + WAIT_PATIENCE[1])

    def verdict(self, change):
        """Who catches the change; "" where nobody does, None where it does not compile."""
        path = self.tree.source / change.file
        sound = path.read_text()
        path.write_text(change.applied(sound))
        try:
            for number, test in enumerate(self.tests):
                made = self.tree.make(test.split()[0])
                if made.returncode != 0:
                    # A check at compile time has caught it, or it is no C++.
                    return "static_assert" if "static assertion" in made.stdout else None
                if wrong := self.tree.run(test, self.patience[test]):
                    return wrong
            return ""
        finally:
            path.write_text(sound)


def changes_of_group(group, only):
    found = []
    for file in GROUPS[group].files:
        if only in (None, file):
            found += changes_of(file, (ROOT / file).read_text())
    return found


def drawn(changes, sample, seed):
    """A sample in the order of files, so that each is compiled as seldom as can be."""
    if sample and sample < len(changes):
        chosen = random.Random(seed).sample(range(len(changes)), sample)
        changes = [changes[i] for i in sorted(chosen)]
    return changes


def run_group(group, tree, options, explained):
    """How many have survived that nothing explains."""
    all_changes = [change for change in changes_of_group(group, options.file)
                   if options.line in (None, change.line)]
    changes = drawn(all_changes, options.sample, options.seed)
    if not changes:
        return 0
    known = [change for change in changes if explained.has(change)]
    asked = [change for change in changes if not explained.has(change)]
    if options.list:
        for change in asked:
            print(change)
        return 0
    judge = Judge(tree, GROUPS[group].tests)
    counts = {"caught": 0, "survived": 0, "none": 0}
    for change in asked:
        who = judge.verdict(change)
        kind = "none" if who is None else "caught" if who else "survived"
        counts[kind] += 1
        if kind == "survived":
            print(f"{change}\n", flush=True)
        if options.verbose:
            print(f"# {change.file}:{change.line} {change.title}: {who}", flush=True)
    judged = counts["caught"] + counts["survived"]
    rate = 100 * counts["caught"] / judged if judged else 100.0
    print(f"{group}: {counts['caught']} of {judged} caught ({rate:.1f} %), {len(known)} more explained, "
          f"{counts['none']} did not compile; {len(changes)} of {len(all_changes)} drawn", flush=True)
    return counts["survived"]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("group", nargs="*", choices=[*GROUPS, []], help="all without one")
    parser.add_argument("--sample", type=int, help="so many of each group, drawn by chance")
    parser.add_argument("--seed", type=int, default=1, help="what the sample is drawn by")
    parser.add_argument("--file", help="the changes of this file alone")
    parser.add_argument("--line", type=int, help="of these those of this line, to try a survivor again")
    parser.add_argument("--list", action="store_true", help="print the changes, and try none")
    parser.add_argument("--verbose", action="store_true", help="print who caught each")
    parser.add_argument("--work", type=Path, default=WORK, help="where the copy and its build are")
    options = parser.parse_args()
    os.nice(10)
    tree = Tree(options.work)
    if not options.list:
        tree.refresh()
    explained = Explained(Path(__file__).with_name("survivors.txt"))
    survived = sum(run_group(group, tree, options, explained) for group in options.group or GROUPS)
    sys.exit(1 if survived else 0)


if __name__ == "__main__":
    main()
