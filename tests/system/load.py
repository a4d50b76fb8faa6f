"""The gateway under load: 247 nodes on each of 4 serial lines, 2000 over TCP of which 1000 join in
one burst, and 50 clients that read registers ten times a second. All on this machine, and it stops by
itself. Prints what it found, and ends with status 1 where polls were missed.

    ETCM_BIN=build/release/bin /usr/bin/python3 tests/system/load.py [--seconds 60]

A poll is due every interval; a serial line cannot do better than its bytes and silences allow, so the
interval is chosen above that floor. What counts is how many questions were asked in the time, of those
due.
"""
import argparse
import os
import pathlib
import re
import selectors
import shutil
import signal
import socket
import struct
import sys
import tempfile
import time
import urllib.request

HERE = pathlib.Path(__file__).parent
sys.path.insert(0, str(HERE.parent / "support"))
from programs import Program, free_port

PROGRAMS = pathlib.Path(os.environ["ETCM_BIN"]).resolve()
LINES, LINE_UNITS = 4, 247
TCP_NODES, BURST = 2000, 1000
CLIENTS, CLIENT_HZ = 50, 10
BAUD = 115200
INTERVAL_S = 2.0
MISSED_MAX = 0.05
# One question and its answer: 37 characters of 11 bits, and two silences of 1.75 ms.
SERIAL_FLOOR_S = LINE_UNITS * (37 * 11 / BAUD + 2 * 0.00175)


def place(number):
    """Spread over a square of 100 km, the same in every run."""
    return number * 7919 % 99991, number * 104729 % 99989


class Load:
    def __init__(self, folder, seconds):
        self.folder = folder
        self.seconds = seconds
        self.programs = []

    def start(self, name, *command):
        program = Program(self.folder, name, [str(part) for part in command])
        self.programs.append(program)
        return program

    def stop(self):
        for program in reversed(self.programs):
            program.stop(signal.SIGTERM)

    def start_nodes(self, burst_ms):
        serial = 1
        buses = []
        for line in range(LINES):
            rows = []
            for _ in range(LINE_UNITS):
                rows.append("0,%d,join,%d,%d" % (serial, *place(serial)))
                serial += 1
            self.write_nodes(f"line{line}", rows)
            path = self.folder / f"cable{line}"
            self.start(f"line{line}", PROGRAMS / "etcm-nodes", "--rtu", path, "--baud", BAUD,
                       "--nodes", f"line{line}.csv").wait_for_line("ready:")
            buses.append(f'rtu = "{path}"\nunits = "1-{LINE_UNITS}"\nbaud = {BAUD}\n'
                         'timeout = "100ms"\n')
        # Which 1000 are late is spread over all ports.
        rows = [("%d" % (burst_ms if n % 2 else 0)) + ",%d,join,%d,%d" % (serial + n, *place(serial + n))
                for n in range(TCP_NODES)]
        assert sum(row.startswith(f"{burst_ms},") for row in rows) == BURST
        self.write_nodes("tcp", rows)
        nodes = self.start("tcp", PROGRAMS / "etcm-nodes", "--listen", "127.0.0.1:0", "--nodes",
                           "tcp.csv")
        nodes.wait_for_line("ready:")
        buses += [f'tcp = "{address}"\nunits = "{units}"\noutstanding = 32\n' for address, units in
                  re.findall(r"listens on (\S+) for units (\S+)", nodes.log())]
        return buses

    def write_nodes(self, name, rows):
        (self.folder / f"{name}.csv").write_text(
            "time_ms,serial,event,x,y\n" + "\n".join(rows) + "\n")

    def start_gateway(self, buses):
        self.http = free_port()
        config = f"""
[mesh]
vertices_max = 4000
[poll]
interval = "{int(INTERVAL_S * 1000)}ms"
timeout = "100ms"
absent_interval = "2s"
stale_after = "10s"
leave_after = "60s"
[analysis]
radio_range = 3000
sensing_range = 2000
[server]
listen = "127.0.0.1:0"
clients_max = {2 * CLIENTS}
[http]
listen = "127.0.0.1:{self.http}"
"""
        (self.folder / "site.toml").write_text(config + "".join("[[bus]]\n" + bus for bus in buses))
        gateway = self.start("gateway", PROGRAMS / "etcm-gateway", "--config", "site.toml")
        self.port = int(gateway.wait_for_line(r"serves the mesh on \S+:(\d+)").group(1))
        self.pid = gateway.process.pid

    def metrics(self):
        with urllib.request.urlopen(f"http://127.0.0.1:{self.http}/metrics", timeout=20) as answer:
            text = answer.read().decode()
        requests, errors = {}, 0
        for bus, count in re.findall(r'^etcm_unit_requests_total\{bus="([^"]*)"[^}]*\} (\d+)', text, re.M):
            requests[bus] = requests.get(bus, 0) + int(count)
        for count in re.findall(r"^etcm_unit_errors_total\{[^}]*\} (\d+)", text, re.M):
            errors += int(count)
        nodes = int(re.search(r"^etcm_nodes(?:\{[^}]*\})? (\d+)", text, re.M).group(1))
        return requests, errors, nodes

    def resident_kib(self):
        status = pathlib.Path(f"/proc/{self.pid}/status").read_text()
        return int(re.search(r"VmRSS:\s+(\d+)", status).group(1))

    def cpu_s(self):
        fields = pathlib.Path(f"/proc/{self.pid}/stat").read_text().rsplit(")", 1)[1].split()
        return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


class Clients:
    """Masters that read the header and a vertex block by turns, each ten times a second."""

    def __init__(self, port):
        self.selector = selectors.DefaultSelector()
        self.sockets = []
        self.sent, self.answered, self.wrong = 0, 0, 0
        for number in range(CLIENTS):
            client = socket.create_connection(("127.0.0.1", port))
            client.setblocking(False)
            self.sockets.append(client)
            self.selector.register(client, selectors.EVENT_READ)

    def run(self, seconds):
        start = time.monotonic()
        pause = 1 / (CLIENTS * CLIENT_HZ)
        due, turn = start, 0
        while (now := time.monotonic()) < start + seconds:
            while due <= now:
                first = 0 if turn // CLIENTS % 2 == 0 else 120
                request = struct.pack(">HHHBBHH", turn % 65536, 0, 6, 1, 4, first, 120)
                self.sockets[turn % CLIENTS].send(request)
                self.sent += 1
                turn += 1
                due += pause
            for key, _ in self.selector.select(max(0.0, due - time.monotonic())):
                data = key.fileobj.recv(65536)
                # MBAP, unit, function, count, 120 registers.
                size = 7 + 2 + 240
                self.answered += len(data) // size
                self.wrong += len(data) % size != 0

    def close(self):
        for client in self.sockets:
            client.close()


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--seconds", type=int, default=60, help="how long to measure")
    arguments = parser.parse_args()
    folder = pathlib.Path(tempfile.mkdtemp(prefix="etcm_load_"))
    load = Load(folder, arguments.seconds)
    try:
        # The burst comes when the nodes of the start are in, at a time of its own.
        warm_s, burst_s = 19, 20
        started = time.monotonic()
        load.start_gateway(load.start_nodes(burst_s * 1000))
        clients = Clients(load.port)
        clients.run(max(0.0, started + warm_s - time.monotonic()))
        before, errors_before, nodes_before = load.metrics()
        cpu_before, rss_before, at = load.cpu_s(), load.resident_kib(), time.monotonic()
        clients.run(arguments.seconds)
        passed = time.monotonic() - at
        cpu, rss = load.cpu_s() - cpu_before, load.resident_kib()
        after, errors_after, nodes_after = load.metrics()
        clients.close()
    finally:
        load.stop()
        shutil.rmtree(folder)

    failed = False
    print(f"nodes: {nodes_before} before the burst, {nodes_after} after it")
    units = LINES * LINE_UNITS + TCP_NODES
    failed |= nodes_after != units
    for kind, is_line, count in (("serial lines", True, LINES * LINE_UNITS),
                                 ("TCP", False, TCP_NODES)):
        asked = sum(after[bus] - before[bus] for bus in after if ("cable" in bus) == is_line)
        due = count * passed / max(INTERVAL_S, SERIAL_FLOOR_S if is_line else 0)
        missed = max(0.0, 1 - asked / due)
        failed |= missed > MISSED_MAX
        print(f"{kind}: {asked} questions of {due:.0f} due: {missed:.1%} missed")
    print(f"serial floor: a sweep takes {SERIAL_FLOOR_S:.2f} s, the interval is {INTERVAL_S} s")
    print(f"questions without a sound answer: {errors_after - errors_before} "
          f"(units that had not joined included)")
    print(f"clients: {clients.sent} requests, {clients.answered} answered, {clients.wrong} cut short")
    failed |= clients.wrong > 0 or clients.answered < clients.sent * 0.95
    print(f"CPU: {cpu / passed:.1%} of a core; RSS: {rss_before} KiB before, {rss} KiB after "
          f"{passed:.0f} s")
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    main()
