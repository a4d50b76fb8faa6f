"""The gateway as other hosts of its network see it: on a host of its own, a network namespace, with
another as the others: a browser that looks at a page beside this test gives up what it is loading where
the network of its own machine changes.

ETCM_BIN is the programs' folder. Needs root and ip (iproute2); elsewhere it is skipped. Every wait is
for a condition.
"""
import http.client
import os
import pathlib
import re
import shutil
import socket
import struct
import subprocess
import sys
import unittest

from gateway_test import GatewayCase, PATIENCE_S, PROGRAMS, wait_for

SKIPPED = 77
HAS_LEFT = "ETCM_HAS_LEFT"  # in the environment of a test that runs in a namespace already
# Kept free by RFC 2544 for measurements between devices: no site has it.
HOST, INSIDE, OUTSIDE = "198.18.77.1", "198.18.77.2", "198.18.77.3"
REGISTERS, PAGE, LINE = 1502, 8080, 1510
READ_HEADER = struct.pack(">HHHBBHH", 1, 0, 6, 1, 4, 2, 1)
# What all that a client can hold of a gateway may come to, the allocator's own included.
GROWTH_MOST = 24 << 20


def ip(*words):
    subprocess.run(["ip", *words], check=True, capture_output=True, text=True, timeout=PATIENCE_S)


def leave_the_machine():
    """Runs this test anew in a network namespace."""
    if os.geteuid() != 0 or not shutil.which("ip"):
        print("network: needs root and ip (iproute2)")
        sys.exit(SKIPPED)
    others = f"etcm-others{os.getpid()}"
    try:
        ip("netns", "add", others)
    except subprocess.CalledProcessError as error:
        print(f"network: this machine makes no network namespace: {error.stderr.strip()}")
        sys.exit(SKIPPED)
    try:
        again = [sys.executable, *sys.argv]
        return subprocess.call(["ip", "netns", "exec", others, *again], env=os.environ | {HAS_LEFT: "1"})
    finally:
        ip("netns", "delete", others)


def setUpModule():
    global NAMESPACE
    NAMESPACE = f"etcm{os.getpid()}"
    ip("netns", "add", NAMESPACE)
    unittest.addModuleCleanup(ip, "netns", "delete", NAMESPACE)
    ours = f"v{os.getpid()}"
    ip("link", "add", ours, "type", "veth", "peer", "name", "eth0", "netns", NAMESPACE)
    for address in (INSIDE, OUTSIDE):
        ip("address", "add", f"{address}/24", "dev", ours)
    ip("link", "set", ours, "up")
    ip("link", "set", "lo", "up")
    ip("-n", NAMESPACE, "address", "add", f"{HOST}/24", "dev", "eth0")
    ip("-n", NAMESPACE, "link", "set", "eth0", "up")
    ip("-n", NAMESPACE, "link", "set", "lo", "up")


class Network(GatewayCase):
    def start_on_its_host(self, server, http_settings, more=""):
        (self.folder / "site.toml").write_text(f"""
[mesh]
vertices_max = 200
[server]
{server}
[http]
{http_settings}
[files]
folder = "out"
[control]
socket = "control"
{more}""")
        gateway = self.start("gateway", ["ip", "netns", "exec", NAMESPACE, PROGRAMS / "etcm-gateway",
                                         "--config", "site.toml"])
        gateway.wait_for_line(r"status page on http://")
        return gateway

    def connect(self, port, source):
        return socket.create_connection((HOST, port), timeout=PATIENCE_S, source_address=(source, 0))

    @staticmethod
    def told(connection):
        """All that comes until the other side ends."""
        parts = []
        try:
            while part := connection.recv(65536):
                parts.append(part)
        except ConnectionResetError:
            pass
        return b"".join(parts)

    def ask(self, path, source=INSIDE, headers=()):
        connection = http.client.HTTPConnection(HOST, PAGE, timeout=PATIENCE_S, source_address=(source, 0))
        connection.request("GET", path, headers=dict(headers))
        answer = connection.getresponse()
        text = answer.read().decode()
        connection.close()
        return answer.status, text

    @staticmethod
    def listening():
        """Every address and port of that host on which something listens, and every socket for datagrams."""
        lines = subprocess.run(["ip", "netns", "exec", NAMESPACE, "cat", "/proc/net/tcp", "/proc/net/tcp6",
                                "/proc/net/udp", "/proc/net/udp6"],
                               capture_output=True, text=True, check=True).stdout
        found = set()
        for address, port, state in re.findall(r"^ *\d+: ([0-9A-F]+):([0-9A-F]{4}) \S+ ([0-9A-F]{2})", lines, re.M):
            if state in ("0A", "07"):
                found.add((address, int(port, 16)))
        return found

    def test_what_listens_on_loopback_is_not_to_be_reached_from_another_host(self):
        bus = ('[[bus]]\nname = "line"\ntcp = "127.0.0.1:9"\nunits = "1"\n'
               f'share = "127.0.0.1:{LINE}"\n')
        self.start_on_its_host(f'listen = "127.0.0.1:{REGISTERS}"', f'listen = "127.0.0.1:{PAGE}"', bus)
        wait_for("all that listens", lambda: {port for _, port in self.listening()} >= {REGISTERS, PAGE, LINE})
        self.assertEqual(self.listening(), {("0100007F", port) for port in (REGISTERS, PAGE, LINE)})
        for port in (REGISTERS, PAGE, LINE):
            with self.assertRaises(ConnectionRefusedError):
                self.connect(port, INSIDE)

    def test_who_is_not_allowed_is_told_nothing(self):
        allow = f'allow = ["{INSIDE}"]'
        gateway = self.start_on_its_host(f'listen = "0.0.0.0:{REGISTERS}"\n{allow}',
                                         f'listen = "0.0.0.0:{PAGE}"\n{allow}')
        self.assertEqual(self.ask("/healthz"), (200, "ok\n"))
        with self.connect(REGISTERS, INSIDE) as master:
            master.sendall(READ_HEADER)
            self.assertEqual(master.recv(260)[7:11], b"\x04\x02\x4d\x45")
        for path in ("/", "/mesh.json", "/mesh.geojson", "/status.json", "/ages.json", "/metrics", "/healthz",
                     "/guide", "/alarms.json", "/page.js"):
            status, text = self.ask(path, source=OUTSIDE)
            self.assertEqual(status, 403, path)
            self.assertIn(OUTSIDE, text)
            self.assertNotIn("vertices", text, path)
        with self.connect(REGISTERS, OUTSIDE) as master:
            try:
                master.sendall(READ_HEADER)
            except ConnectionResetError:
                pass
            self.assertEqual(self.told(master), b"")
        gateway.wait_for_line(re.escape(OUTSIDE))

    @staticmethod
    def resident(gateway):
        status = pathlib.Path(f"/proc/{gateway.process.pid}/status").read_text()
        return int(re.search(r"VmRSS:\s+(\d+) kB", status).group(1)) << 10

    def test_requests_that_are_wrong_in_any_way_cost_bounded_memory_and_end(self):
        gateway = self.start_on_its_host(f'listen = "0.0.0.0:{REGISTERS}"\nallow = ["{INSIDE}"]',
                                         f'listen = "0.0.0.0:{PAGE}"\nallow = ["{INSIDE}"]')
        self.assertEqual(self.ask("/mesh.json")[0], 200)
        before = self.resident(gateway)
        for port, request in (
                (PAGE, b"GET /" + b"a" * (8 << 20) + b" HTTP/1.1\r\n\r\n"),
                (PAGE, b"GET / HTTP/1.1\r\nX: " + b"a" * (8 << 20) + b"\r\n\r\n"),
                (PAGE, b"GET / HTTP/1.1\r\n" + b"X: a\r\n" * 500_000 + b"\r\n"),
                (PAGE, b"POST / HTTP/1.1\r\nHost: localhost\r\nContent-Length: 9223372036854775807\r\n\r\n"
                 + b"a" * (8 << 20)),
                (PAGE, b"PUT /mesh.json HTTP/1.1\r\nHost: localhost\r\nTransfer-Encoding: chunked\r\n\r\n"
                 + b"FFFFFFFFFFFFFFFF\r\n" + b"a" * (8 << 20)),
                (PAGE, bytes(range(256)) * 4096),
                (PAGE, b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03" + b"\0" * 4096),
                (REGISTERS, struct.pack(">HHHBB", 1, 0, 65535, 1, 4) + b"a" * (8 << 20)),
                (REGISTERS, struct.pack(">HHHBB", 1, 7, 6, 1, 4) * 200_000),
                (REGISTERS, b"GET / HTTP/1.1\r\n\r\n" * 100_000),
                (REGISTERS, b"\0" * (8 << 20))):
            with self.connect(port, INSIDE) as client:
                try:
                    client.sendall(request)
                    client.shutdown(socket.SHUT_WR)
                except (BrokenPipeError, ConnectionResetError):
                    pass
                except OSError as error:
                    self.assertIn(error.errno, (107,), error)  # hung up on before the end
                self.told(client)
            with self.subTest(request=request[:40]):
                self.assertEqual(self.ask("/healthz"), (200, "ok\n"))
                self.assertLess(self.resident(gateway) - before, GROWTH_MOST)
        with self.connect(REGISTERS, INSIDE) as master:
            master.sendall(READ_HEADER)
            self.assertEqual(master.recv(260)[7:9], b"\x04\x02")
        self.assertEqual(gateway.stop(), 0, gateway.log())


if __name__ == "__main__":
    if HAS_LEFT not in os.environ:
        sys.exit(leave_the_machine())
    unittest.main()
