"""The gateway for an hour: 500 nodes that come, move and go all the time, with features, files and state,
a page that is asked for; or killed 200 times at random moments. No test: it takes its time. Prints what it
found, and ends with status 1 where something grew, got slower or was lost.

    ETCM_BIN=build/release/bin /usr/bin/python3 tests/system/soak.py [--seconds 3600]
    ETCM_BIN=build/release/bin /usr/bin/python3 tests/system/soak.py --kills 200 [--seed 1]
"""
import argparse
import os
import pathlib
import random
import re
import shutil
import signal
import sys
import tempfile
import time
import urllib.request

HERE = pathlib.Path(__file__).parent
sys.path.insert(0, str(HERE.parent / "support"))
from programs import Program, free_port

PROGRAMS = pathlib.Path(os.environ["ETCM_BIN"]).resolve()
NODES, FEATURES, SIDE = 500, 40, 100_000
CHANGES_A_SECOND = 5
SAMPLE_EVERY_S = 5
# What a half of the time may differ by from the half before it: RSS settles for a while.
GROWTH_MOST, SLOWER_MOST = 0.02, 1.5


def events(seconds, chance):
    """Rows of what the nodes do. Those with features stay, for a feature whose end has left is no feature."""
    place = lambda: (chance.randrange(SIDE), chance.randrange(SIDE))
    rows = ["0,%d,join,%d,%d" % (serial, *place()) for serial in range(1, NODES + 1)]
    is_there = dict.fromkeys(range(2 * FEATURES + 1, NODES + 1), True)
    for change in range(seconds * CHANGES_A_SECOND):
        serial = chance.choice(list(is_there))
        at = 10_000 + change * 1000 // CHANGES_A_SECOND
        if not is_there[serial]:
            rows.append("%d,%d,join,%d,%d" % (at, serial, *place()))
        elif chance.random() < 0.5:
            rows.append("%d,%d,leave,," % (at, serial))
        else:
            rows.append("%d,%d,move,%d,%d" % (at, serial, *place()))
            continue
        is_there[serial] = not is_there[serial]
    return rows


class Site:
    def __init__(self, folder, seconds, seed):
        self.folder = folder
        self.programs = []
        (folder / "nodes.csv").write_text(
            "time_ms,serial,event,x,y\n" + "\n".join(events(seconds, random.Random(seed))) + "\n")
        nodes = self.start("nodes", "etcm-nodes", "--listen", "127.0.0.1:0", "--nodes", "nodes.csv")
        nodes.wait_for_line("ready:")
        self.page = free_port()
        buses = "".join(f'[[bus]]\ntcp = "{address}"\nunits = "{units}"\noutstanding = 32\n' for address, units in
                        re.findall(r"listens on (\S+) for units (\S+)", nodes.log()))
        features = "".join(f"[[feature]]\nfrom = {2 * i + 1}\nto = {2 * i + 2}\n" for i in range(FEATURES))
        (folder / "site.toml").write_text(f"""
[mesh]
vertices_max = 8000
features_max = 400
[poll]
interval = "1s"
absent_interval = "2s"
stale_after = "5s"
leave_after = "10s"
[server]
listen = "127.0.0.1:0"
[http]
listen = "127.0.0.1:{self.page}"
[files]
folder = "out"
interval = "1s"
[state]
folder = "state"
interval = "1s"
{buses}{features}""")

    def start(self, name, program, *words):
        started = Program(self.folder, name, [str(PROGRAMS / program), *map(str, words)])
        self.programs.append(started)
        return started

    def start_gateway(self, name="gateway"):
        gateway = self.start(name, "etcm-gateway", "--config", "site.toml")
        gateway.wait_for_line(r"serves the mesh on")
        return gateway

    def stop(self):
        for program in reversed(self.programs):
            program.stop()

    def ask(self, path):
        start = time.monotonic()
        with urllib.request.urlopen(f"http://127.0.0.1:{self.page}{path}", timeout=60) as answer:
            answer.read()
        return 1e3 * (time.monotonic() - start)


def sample(site, gateway):
    process = pathlib.Path(f"/proc/{gateway.process.pid}")
    rss = int(re.search(r"VmRSS:\s+(\d+)", (process / "status").read_text()).group(1))
    descriptors = len(list((process / "fd").iterdir()))
    return rss, descriptors, site.ask("/mesh.json"), site.ask("/status.json")


def percentile(values, part):
    ordered = sorted(values)
    return ordered[min(len(ordered) - 1, int(part * len(ordered)))]


def soak(site, seconds):
    gateway = site.start_gateway()
    # Until all are in and what is allocated once has been.
    time.sleep(min(60, seconds / 10))
    samples, end = [], time.monotonic() + seconds
    while time.monotonic() < end:
        samples.append(sample(site, gateway))
        time.sleep(SAMPLE_EVERY_S)
    half = len(samples) // 2
    failed = False
    print("| | first half | second half |\n|---|---:|---:|")
    for name, column, part, most in (("RSS, KiB, median", 0, 0.5, 1 + GROWTH_MOST),
                                     ("descriptors, most", 1, 1, 1),
                                     ("mesh.json, ms, median", 2, 0.5, SLOWER_MOST),
                                     ("mesh.json, ms, p99", 2, 0.99, None),
                                     ("status.json, ms, median", 3, 0.5, SLOWER_MOST),
                                     ("status.json, ms, p99", 3, 0.99, None)):
        before, after = (percentile([row[column] for row in rows], part) for rows in (samples[:half], samples[half:]))
        print(f"| {name} | {before:.4g} | {after:.4g} |")
        failed |= most is not None and after > before * most
    code = gateway.stop()
    joined, left = (len(re.findall(word, gateway.log())) for word in (" joined", " left"))
    print(f"{joined} lines of joins and {left} of leaves; the gateway ended with {code}")
    failed |= code != 0 or "audit passed: conforming" not in gateway.log()
    return failed


def kill(site, kills, chance):
    """Each start finds the state of the run before, or of a moment earlier in it: generations only grow."""
    generation = wrong = 0
    for number in range(kills + 1):
        gateway = site.start_gateway(f"gateway{number}")
        # It listens before it has looked at its state, and joins nobody before.
        gateway.wait_for_line(r"restored the|joined")
        log = gateway.log()
        found = re.search(r"restored the mesh of generation (\d+)", log)
        if "state.refused" in log or (number > 5 and not found) or (found and int(found.group(1)) < generation):
            wrong += 1
            print(f"start {number} after generation {generation}:\n{log}")
        if found:
            generation = int(found.group(1))
        time.sleep(chance.uniform(0, 2))
        gateway.stop(signal.SIGKILL if number < kills else signal.SIGTERM)
        if number < kills:
            gateway.log_path.unlink()
    print(f"killed {kills} times, generation {generation} at the last start; {wrong} starts without the state, or "
          "with an older one than before")
    return wrong != 0 or "audit passed: conforming" not in gateway.log()


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--seconds", type=int, default=3600, help="how long to watch it")
    parser.add_argument("--kills", type=int, default=0, help="kill it so many times instead")
    parser.add_argument("--seed", type=int, default=1)
    arguments = parser.parse_args()
    folder = pathlib.Path(tempfile.mkdtemp(prefix="etcm_soak_"))
    site = Site(folder, arguments.seconds + 600, arguments.seed)
    try:
        if arguments.kills:
            failed = kill(site, arguments.kills, random.Random(arguments.seed))
        else:
            failed = soak(site, arguments.seconds)
    finally:
        site.stop()
        shutil.rmtree(folder)
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    main()
