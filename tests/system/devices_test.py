"""The gateway with devices of other makers, which pymodbus plays: over TCP, and on a serial line
with a transmitter that was surveyed. Read by mbpoll. The programs' folder is in ETCM_BIN."""
import json
import os
import pathlib
import re
import struct
import signal
import subprocess
import sys
import threading
import time
import tty
import unittest
import urllib.request

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "support"))
from gateway_test import PROGRAMS, GatewayCase
from programs import PATIENCE_S, free_port, wait_for

PROFILES = HERE.parents[1] / "firmware" / "profiles"
DEVICE = HERE.parent / "profile" / "pymodbus_device.py"

ROVER = """
[[profile]]
name = "rover"
function = 4
counts_from = 30001
serial = { register = 30001, type = "u32" }
valid = { register = 30301, mask = 0x00FF, equals = "A" }
x = { register = 30101, type = "i32", order = "CDAB", scale = "0.001" }
y = { register = 30103, type = "i32", order = "CDAB", scale = "0.001" }
"""


def words(at, form, value):
    """Registers with the number, the most significant first."""
    return dict(enumerate(struct.unpack(">HH", struct.pack(form, value)), start=at))


def f32(at, value):
    return words(at, ">f", value)


def i32(at, value):
    return words(at, ">i", value)


def swapped(value):
    high, low = struct.unpack(">HH", struct.pack(">i", value))
    return [low, high]


def rover(serial, x_mm, y_mm, valid="A"):
    registers = {0: serial >> 16, 1: serial & 0xFFFF, 300: 0x2000 | ord(valid)}
    registers |= dict(enumerate(swapped(x_mm) + swapped(y_mm), start=100))
    return {"4": registers}


def crc(frame):
    value = 0xFFFF
    for byte in frame:
        value ^= byte
        for _ in range(8):
            value = value >> 1 ^ (0xA001 if value & 1 else 0)
    return frame + struct.pack("<H", value)


class LateUnit(threading.Thread):
    """A unit on a terminal of its own that has one way to be read, and answers each question when it
    hears the next one: where that comes within 5 s."""

    def __init__(self):
        super().__init__(daemon=True)
        self.end, self.other_end = os.openpty()
        tty.setraw(self.end)
        tty.setraw(self.other_end)
        self.path = os.ttyname(self.other_end)
        self.heard = 0
        self.start()

    def run(self):
        asked, earlier = b"", None
        while True:
            asked += os.read(self.end, 256)
            if len(asked) < 8:
                continue
            self.heard += 1
            now, answer = time.monotonic(), crc(struct.pack(">BBB2H", asked[0], asked[1], 4,
                                                            self.heard, self.heard))
            if earlier is not None and now - earlier[0] < 5:
                os.write(self.end, earlier[1])
            asked, earlier = asked[8:], (now, answer)


class Devices(GatewayCase):
    def serve(self, name, address, units):
        self.start(name, [sys.executable, DEVICE, address, json.dumps(units)])

    def test_of_three_kinds_are_one_mesh(self):
        nodes = self.start_nodes(["0,7,join,300,-200"])
        tcp = free_port()
        self.serve("rovers", tcp, {"1": rover(70001, 100_400, -7_600), "2": rover(70002, 0, 250_501),
                                   "3": rover(70003, 9_000, 9_000, valid="V")})
        near, far = self.folder / "near", self.folder / "far"
        self.start("line", ["socat", f"pty,raw,echo=0,link={near}", f"pty,raw,echo=0,link={far}"])
        wait_for("the line", lambda: near.exists() and far.exists())
        self.serve("transmitters", far, {"5": {"3": {"0": 1234}}})
        self.start_gateway(nodes, head=f'profiles = "{PROFILES}"\n{ROVER}', more=f"""
[[bus]]
tcp = "127.0.0.1:{tcp}"
name = "rovers"
[[bus.device]]
units = "1-3"
profile = "rover"
pause = "20ms"
[[bus]]
rtu = "{near}"
name = "tanks"
baud = 9600
parity = "none"
[[bus.device]]
units = "5"
profile = "transmitter"
[[node]]
bus = "tanks"
unit = 5
x = "-400.4"
y = 80
""")
        self.wait_for_header(nodes=4, state=1)  # the third rover waits for a fix
        self.assertEqual(self.vertices(), {7: (300, -200), 70001: (100, -8), 70002: (0, 251),
                                           3005: (-400, 80)})

    def test_behind_a_serial_server_that_passes_frames_on(self):
        port = free_port()
        gateway = self.start_gateway([], head=ROVER, more=f"""
[[bus]]
tcp = "127.0.0.1:{port}"
framing = "rtu"
name = "server"
[[bus.device]]
units = "1-3"
profile = "rover"
""")
        gateway.wait_for_line(rf"bus server: 127\.0\.0\.1:{port}: .*; trying again")
        self.serve("server", f"rtu:{port}", {"1": rover(70001, 100_400, -7_600),
                                             "2": rover(70002, 0, 250_501)})
        gateway.wait_for_line(rf"bus server: opened 127\.0\.0\.1:{port}")
        self.wait_for_header(nodes=2)
        self.assertEqual(self.vertices(), {70001: (100, -8), 70002: (0, 251)})

    def test_from_shops_are_on_a_map_in_degrees(self):
        tcp = [free_port(), free_port()]
        self.serve("router", tcp[0], {"1": {"3": f32(143, 63.4305) | f32(145, 10.3951)}})
        self.serve("boat", tcp[1], {"100": {"3": i32(2800, 634_310_000) | i32(2802, 103_970_000) |
                                            {2806: 1, 2807: 9}}})
        near, far = self.folder / "near", self.folder / "far"
        self.start("line", ["socat", f"pty,raw,echo=0,link={near}", f"pty,raw,echo=0,link={far}"])
        wait_for("the line", lambda: near.exists() and far.exists())
        terminal = {200: 1, 207: ord("E"), 210: ord("N")} | f32(208, 10.3960) | f32(211, 63.4295) | \
            f32(213, 0.3) | f32(215, 90)
        self.serve("terminals", far, {"3": {"3": terminal}, "5": {"3": {"0": 120}},
                                      "6": {"3": {"0": 150}}, "7": {"3": {"0": 190}}})
        gateway = self.start_gateway([], head=f'profiles = "{PROFILES}"\n[site]\nunit = "0.01"\n',
                                     more=f"""
[http]
listen = "127.0.0.1:0"
[[bus]]
tcp = "127.0.0.1:{tcp[0]}"
[[bus.device]]
units = "1"
profile = "teltonika-rut955"
[[bus]]
tcp = "127.0.0.1:{tcp[1]}"
[[bus.device]]
units = "100"
profile = "victron-gx"
[[bus]]
rtu = "{near}"
name = "quay"
baud = 9600
parity = "none"
[[bus.device]]
units = "3"
profile = "ebyte-e108"
[[bus.device]]
units = "5-7"
profile = "transmitter"
[[node]]
bus = "quay"
unit = 5
longitude = "10.394"
latitude = "63.4300"
[[node]]
bus = "quay"
unit = 6
longitude = "10.398"
latitude = "63.4300"
[[node]]
bus = "quay"
unit = 7
longitude = "10.396"
latitude = "63.4315"
""")
        url = gateway.wait_for_line(r"status page on (http://\S+)").group(1)
        self.wait_for_header(nodes=6)
        with urllib.request.urlopen(url + "/mesh.geojson", timeout=30) as answer:
            features = json.loads(answer.read())["features"]
        nodes = {feature["properties"]["serial"]: feature for feature in features
                 if feature["properties"]["kind"] == "node"}
        for serial, place in {1001: (10.3951, 63.4305), 2100: (10.397, 63.431),
                              3003: (10.396, 63.4295), 3005: (10.394, 63.43)}.items():
            longitude, latitude = nodes[serial]["geometry"]["coordinates"]
            self.assertAlmostEqual(longitude, place[0], delta=1e-6, msg=serial)
            self.assertAlmostEqual(latitude, place[1], delta=1e-6, msg=serial)
        self.assertEqual(nodes[3005]["properties"]["x"], 0, "the first [[node]] is the middle")
        with urllib.request.urlopen(url + "/units.json", timeout=30) as answer:
            units = json.loads(answer.read())["units"]
        self.assertEqual([unit["unit"] for unit in units if unit.get("surveyed")], [5, 6, 7])
        with urllib.request.urlopen(url + "/readings.json", timeout=30) as answer:
            self.assertRegex(answer.read().decode(), r"\[3003,\d+,0\.3,", "in the digits of a real of 32 bits")
        gateway.wait_for_line(r"node 3005 joined at \(0, 0\), 63\.430000° N, 10\.394000° E: ")

    # As it stands there, but for where the devices are.
    def test_the_guides_first_evening(self):
        port = free_port()
        self.serve("router", port, {"1": {"3": f32(143, 63.4305) | f32(145, 10.3951)}})
        near, far = self.folder / "near", self.folder / "far"
        self.start("line", ["socat", f"pty,raw,echo=0,link={near}", f"pty,raw,echo=0,link={far}"])
        wait_for("the line", lambda: near.exists() and far.exists())
        terminal = {200: 1, 207: ord("E"), 210: ord("N")} | f32(208, 10.3960) | f32(211, 63.4295) | \
            f32(213, 0.5) | f32(215, 90)
        self.serve("terminals", far, {"3": {"3": terminal}} | {
            str(unit): {"3": {"0": 1000 + unit}} for unit in (5, 6, 7)})
        guide = (PROFILES.parent / "guide" / "README.md").read_text()
        text = (PROFILES.parent / "examples" / "devices" / "gateway.toml").read_text()
        for there, here in {"192.168.1.1:502": f"127.0.0.1:{port}", "/dev/serial/by-path/...": near,
                            "127.0.0.1:8080": "127.0.0.1:0", "127.0.0.1:1502": "127.0.0.1:0"}.items():
            self.assertEqual(text.count(there), 1)
            text = text.replace(there, str(here))
        config = self.folder / "gateway.toml"
        config.write_text(f'profiles = "{PROFILES}"\n{text}')
        # They look at the devices while nothing else has the line.
        section = guide[guide.index("### Your own devices"):guide.index("### The service")]
        looks = re.findall(r"^ *(etcm-bus .*)$", section, re.M)
        self.assertEqual(len(looks), 4)
        for unit, first, where in ((7, 0, ["-b", "9600", "-P", "none", str(near)]),
                                   (1, 143, [f"127.0.0.1:{port}"])):
            look = [PROGRAMS / "etcm-bus", "read", "-t", "4", "-a", str(unit), "-r", str(first), *where]
            wait_for("the devices", lambda: subprocess.run(
                look, capture_output=True, timeout=PATIENCE_S).returncode == 0)
        for look in looks:
            words = look.replace("/dev/serial/by-path/...", str(near)).replace(
                "192.168.1.1", f"127.0.0.1:{port}").replace("/etc/etcm/gateway.toml", str(config)).split()
            more = [] if words[1] == "scan" or "--profiles" in words else ["--profiles", str(PROFILES)]
            done = subprocess.run([PROGRAMS / words[0], *words[1:], *more], capture_output=True,
                                  text=True, timeout=PATIENCE_S)
            self.assertEqual(done.returncode, 0, f"{look}\n{done.stdout}{done.stderr}")
            expected = {"scan": r"(?s)^   3 .*^   5 .*^   6 .*^   7 ",
                        "probe": r"^  (position +yes|level .* 1\.005 m)$"}[words[1]]
            self.assertRegex(done.stdout, re.compile(expected, re.M))
        command = [PROGRAMS / "etcm-gateway", "--config", config]
        checked = subprocess.run([*command, "--check-config"], capture_output=True, text=True,
                                 timeout=PATIENCE_S)
        self.assertEqual((checked.returncode, checked.stderr), (0, ""))
        gateway = self.start("gateway", command)
        url = gateway.wait_for_line(r"status page on (http://\S+)").group(1)

        def levels():
            with urllib.request.urlopen(url + "/mesh.geojson", timeout=PATIENCE_S) as answer:
                features = json.loads(answer.read())["features"]
            nodes = [feature["properties"] for feature in features
                     if feature["properties"]["kind"] == "node"]
            return len(nodes) == 5 and {node["serial"]: node["reading level (m)"] for node in nodes
                                        if "reading level (m)" in node}

        self.assertEqual(wait_for("all five", lambda: levels() if levels() and len(levels()) == 3 else None),
                         {2005: 1.005, 2006: 1.006, 2007: 1.007})

    def test_an_answer_to_a_run_before_is_no_position(self):
        unit = LateUnit()
        (self.folder / "site.toml").write_text(f"""
[mesh]
vertices_max = 10
[server]
listen = "127.0.0.1:0"
[[profile]]
name = "late"
x = {{ register = 0 }}
y = {{ register = 1 }}
[[bus]]
rtu = "{unit.path}"
[[bus.device]]
units = "1"
profile = "late"
""")
        for run in (1, 2, 3):
            gateway = self.start(f"run {run}", [PROGRAMS / "etcm-gateway", "--config", "site.toml"])
            gateway.wait_for_line(r"opened .*; asks nothing for 6 s")
            wait_for("a question", lambda: unit.heard == run)
            if run < 3:
                gateway.stop(signal.SIGKILL)
        wait_for("one more", lambda: unit.heard == 4)
        self.assertEqual(gateway.stop(), 0)
        self.assertNotIn("joined", gateway.log())

    def test_that_tell_degrees_need_a_place_to_be_about(self):
        gateway = self.start_gateway([], head=f'profiles = "{PROFILES}"\n', wait=False, more="""
[[bus]]
tcp = "127.0.0.1:9"
[[bus.device]]
units = "1"
profile = "teltonika-rut955"
""")
        gateway.wait_for_line(r"site\.toml:\d+: the devices of 'teltonika-rut955' tell where they "
                              r"stand in degrees, .*; set origin = ")


if __name__ == "__main__":
    unittest.main(defaultTest="Devices")
