"""The first evening of the operating guide, from the package: its commands and settings as they stand
there, but for where the devices are. pymodbus plays these; the gateway runs as the service's command,
with rights as few.
"""
import json
import os
import pathlib
import re
import shutil
import struct
import subprocess
import sys
import unittest
import urllib.request

import package_test
from programs import PATIENCE_S, ProgramCase, free_port, wait_for

DEVICE = pathlib.Path(__file__).resolve().parents[1] / "profile" / "pymodbus_device.py"
NOBODY = "65534"
# Sees the package as if it were installed, and nothing of that stays.
UNPACKED = 'mount -t overlay -o lowerdir="$1/usr:/usr" usr /usr && ' \
    'mount -t overlay -o lowerdir="$1/etc:/etc" etc /etc && shift && exec "$@"'

setUpModule = package_test.setUpModule


def f32(at, value):
    return dict(enumerate(struct.unpack(">HH", struct.pack(">f", value)), start=at))


class FirstEvening(ProgramCase):
    def setUp(self):
        super().setUp()
        self.root = self.folder / "package"
        package_test.run("dpkg-deb", "-x", package_test.GATEWAY, self.root)
        probe = subprocess.run(self.there("etcm-bus", "--help"), capture_output=True, text=True)
        if probe.returncode != 0:
            self.skipTest(f"no file systems can be laid over others here: {probe.stderr}")

    def there(self, *words):
        return ["unshare", "-m", "sh", "-c", UNPACKED, "sh", self.root, *words]

    def serve(self, name, address, units):
        self.start(name, ["/usr/bin/python3", DEVICE, address, json.dumps(units)])

    def serve_all(self):
        """Where they are: {what the guide says: what is so here}."""
        port = free_port()
        self.serve("router", port, {"1": {"3": f32(143, 63.4305) | f32(145, 10.3951)}})
        near, far = self.folder / "near", self.folder / "far"
        self.start("line", ["socat", f"pty,raw,echo=0,group=dialout,mode=0660,link={near}",
                            f"pty,raw,echo=0,link={far}"])
        wait_for("the line", lambda: near.exists() and far.exists())
        terminal = {200: 1, 207: ord("E"), 210: ord("N")} | f32(208, 10.3960) | \
            f32(211, 63.4295) | f32(213, 0.5) | f32(215, 90)
        self.serve("terminals", far, {"3": {"3": terminal}} | {
            str(unit): {"3": {"0": 1000 + unit}} for unit in (5, 6, 7)})
        return {"/dev/serial/by-path/...": str(near.resolve()), "192.168.1.1:502": f"127.0.0.1:{port}",
                "192.168.1.1": f"127.0.0.1:{port}", "127.0.0.1:8080": "127.0.0.1:0", "127.0.0.1:1502": "127.0.0.1:0"}

    def test_of_the_guide_ends_with_a_map_in_degrees(self):
        places = self.serve_all()
        guide = (self.root / "usr/share/doc/etcm-gateway/guide/README.md").read_text()
        section = guide[guide.index("### Your own devices"):guide.index("### The service")]
        for there, here in places.items():
            section = section.replace(there, here)
        example, config = re.search(r"^   sudo cp /(\S+) /(\S+)$", section, re.M).groups()
        settings = (self.root / example).read_text()
        for there, here in places.items():
            settings = settings.replace(there, here)
        (self.root / config).write_text(settings)
        # What follows `&&` is the machine's.
        commands = re.findall(r"^ *((?:etcm-bus|etcm-gateway) .*?)(?: && .*)?$", section, re.M)
        self.assertEqual([command.split()[:2] for command in commands],
                         [["etcm-bus", "scan"], ["etcm-gateway", "--config"], ["etcm-bus", "probe"],
                          ["etcm-bus", "probe"], ["etcm-bus", "probe"]])
        expected = [r"^   3 (.*\n)+   5 (.*\n)+   6 (.*\n)+   7 ", r"^/etc/etcm/gateway.toml: good$",
                    r"^  position +yes$", r"^  position +yes$", r"^  level .* 1\.005 m$"]
        line, router = places["/dev/serial/by-path/..."], places["192.168.1.1"]
        for unit, first, where in ((7, 0, ["-b", "9600", "-P", "none", line]), (1, 143, [router])):
            look = ["etcm-bus", "read", "-t", "4", "-a", str(unit), "-r", str(first), *where]
            wait_for("the devices", lambda: subprocess.run(
                self.there(*look), capture_output=True, timeout=PATIENCE_S).returncode == 0)
        for command, pattern in zip(commands, expected):
            done = subprocess.run(self.there(*command.split()), capture_output=True, text=True,
                                  timeout=PATIENCE_S)
            self.assertEqual(done.returncode, 0, f"{command}\n{done.stdout}{done.stderr}")
            self.assertRegex(done.stdout, re.compile(pattern, re.M))
        service = (self.root / "usr/lib/systemd/system/etcm-gateway.service").read_text()
        start = re.search(r"^ExecStart=(.*)$", service, re.M).group(1).split()
        gateway = self.start("gateway", self.there(
            "setpriv", f"--reuid={NOBODY}", f"--regid={NOBODY}", "--groups=dialout", "--no-new-privs",
            "--inh-caps=-all", "--bounding-set=-all", *start))
        url = gateway.wait_for_line(r"status page on (http://\S+)").group(1)

        def nodes():
            with urllib.request.urlopen(url + "/mesh.geojson", timeout=PATIENCE_S) as answer:
                features = json.loads(answer.read())["features"]
            return {feature["properties"]["serial"]: feature for feature in features
                    if feature["properties"]["kind"] == "node"}

        wait_for("all that are in the guide", lambda: len(nodes()) == 5)
        wait_for("their levels", lambda: {
            serial: node["properties"]["reading level (m)"] for serial, node in nodes().items()
            if "reading level (m)" in node["properties"]} == {2005: 1.005, 2006: 1.006, 2007: 1.007})
        longitude, latitude = nodes()[1001]["geometry"]["coordinates"]
        self.assertAlmostEqual(longitude, 10.3951, delta=1e-5)
        self.assertAlmostEqual(latitude, 63.4305, delta=1e-5)


if __name__ == "__main__":
    if os.geteuid() != 0 or shutil.which("dpkg") is None:
        print("needs root and dpkg; skipped")
        sys.exit(package_test.SKIPPED)
    unittest.main(verbosity=2)
