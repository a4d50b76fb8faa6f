"""etcm-bus probe on devices that pymodbus serves, over TCP and on a serial line. Their registers are
written here as their makers' manuals have them, not as the profiles do. The program is in ETCM_BUS."""
import json
import os
import pathlib
import re
import struct
import subprocess
import sys
import unittest

from programs import PATIENCE_S, ProgramCase, free_port, wait_for

BUS = os.environ["ETCM_BUS"]
HERE = pathlib.Path(__file__).resolve().parent
FIRMWARE = HERE.parents[1] / "firmware"
PROFILES = FIRMWARE / "profiles"
NOT_VALID = ("no: it says that its position is not valid; look at the sky above its antenna, and its cable; if it has a "
             "fix, correct 'valid', 'function' and 'counts_from' in its profile (etcm-bus probe shows what stands there)")


def words(pattern, *values):
    """The registers of a struct, the highest byte first."""
    packed = struct.pack(">" + pattern, *values)
    return list(struct.unpack(f">{len(packed) // 2}H", packed))


def at(*blocks):
    """Registers by their address: at((200, [1]), (207, [0x57]))."""
    return {first + i: word for first, block in blocks for i, word in enumerate(block)}


def ebyte(valid, longitude, latitude, speed=0.0, course=0.0):
    return {"3": at((200, [valid]), (207, [0x57 if longitude < 0 else 0x45]),
                    (208, words("f", abs(longitude))), (210, [0x53 if latitude < 0 else 0x4E]),
                    (211, words("f", abs(latitude))), (213, words("ff", speed, course)))}


def teltonika(latitude, longitude):
    return {"3": at((143, words("ff", latitude, longitude)))}


def victron(latitude, longitude, fix, satellites):
    return {"3": at((2800, words("ii", round(latitude * 1e7), round(longitude * 1e7))),
                    (2806, [fix, satellites]))}


def mobiltex(latitude, longitude, present=1, lock=1):
    lowest_first = lambda value: words("d", value)[::-1]
    return {"3": at((40701, [present]), (40705, lowest_first(latitude)),
                    (40709, lowest_first(longitude)), (40725, [lock]))}


class ProbeCase(ProgramCase):
    def probe(self, *arguments, code=0):
        done = subprocess.run([BUS, "probe", "-o", "5", *map(str, arguments)], capture_output=True,
                              text=True, timeout=PATIENCE_S)
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        return done

    def serve(self, address, units, *device):
        """What etcm-bus is told to ask them."""
        self.start("device", [sys.executable, HERE / "pymodbus_device.py", address, json.dumps(units)])
        # Whoever says anything is there, be it that there is no such register.
        ask = [BUS, "read", "-a", next(iter(units)), "-r", "65000", *device]
        wait_for("the device", lambda: "exception" in subprocess.run(
            ask, capture_output=True, text=True, timeout=PATIENCE_S).stderr)
        return device

    def start_tcp(self, units):
        port = free_port()
        return self.serve(port, units, f"127.0.0.1:{port}")

    def start_line(self, units):
        """On a serial line: two ends of pseudo-terminals."""
        near, far = self.folder / "near", self.folder / "far"
        self.start("line", ["socat", f"pty,raw,echo=0,link={near}", f"pty,raw,echo=0,link={far}"])
        wait_for("the line", lambda: near.exists() and far.exists())
        return self.serve(far, units, "-b", "9600", "-P", "none", str(near))

    def fields(self, name, device, unit, profiles=PROFILES):
        """What stands behind each field."""
        done = self.probe("--profiles", profiles, "--profile", name, "-a", unit, *device)
        self.assertEqual(done.stderr, "")
        lines = done.stdout.splitlines()
        self.assertRegex(lines[0], rf"^unit {unit}, {name}: \d+ registers in \d+ questions?$")
        rows = [re.split(r" {2,}", line.strip()) for line in lines[1:]]
        self.assertEqual(rows[0], ["field", "registers", "raw", "value"])
        return {row[0]: row[-1] for row in rows[1:]}

    def number(self, fields, name, unit):
        value, shown = fields[name].split()
        self.assertEqual(shown, unit)
        return float(value)

    def assertPosition(self, fields, longitude, latitude, digits):
        self.assertEqual(fields["position"], "yes")
        self.assertAlmostEqual(self.number(fields, "longitude", "degrees"), longitude, digits)
        self.assertAlmostEqual(self.number(fields, "latitude", "degrees"), latitude, digits)


class Lines(ProbeCase):
    def test_ebyte_e108(self):
        line = self.start_line({"5": ebyte(1, -122.25, -33.875, 12.5, 359.5),
                                "6": ebyte(1, 13.404954, 52.520008),
                                "7": ebyte(0, 0, 0),
                                "8": ebyte(1, float("nan"), 5),
                                "9": ebyte(1, 5, 91)})
        west = self.fields("ebyte-e108", line, 5)
        self.assertPosition(west, -122.25, -33.875, 9)
        self.assertEqual((west["valid"], west["speed"], west["course"]),
                         ("yes", "12.5 kn", "359.5 degrees"))
        self.assertPosition(self.fields("ebyte-e108", line, 6), 13.404954, 52.520008, 5)
        self.assertEqual(self.fields("ebyte-e108", line, 7)["position"],
                         NOT_VALID)
        nobody = self.fields("ebyte-e108", line, 8)
        self.assertEqual((nobody["longitude"], nobody["position"][:3]), ("none", "no:"))
        self.assertEqual(self.fields("ebyte-e108", line, 9)["position"][:3], "no:")

    def test_mobiltex_rmu5(self):
        line = self.start_line({"1": mobiltex(51.045123456, -114.057123456),
                                "2": mobiltex(51.0, -114.0, lock=0),
                                "3": mobiltex(51.0, -114.0, present=0)})
        self.assertPosition(self.fields("mobiltex-rmu5", line, 1), -114.057123456, 51.045123456, 9)
        for unit in 2, 3:
            self.assertEqual(self.fields("mobiltex-rmu5", line, unit)["position"],
                             NOT_VALID)

    def test_transmitter(self):
        line = self.start_line({"1": {"3": {0: 0x10000 - 123}}, "2": {"3": {0: 0x8000}}})
        self.assertEqual(self.fields("transmitter", line, 1), {"value": "-123"})
        self.assertEqual(self.fields("transmitter", line, 2), {"value": "none"})


class Networks(ProbeCase):
    def test_teltonika_rut955(self):
        device = self.start_tcp({"1": teltonika(54.898521, 23.903597), "2": teltonika(0, 0)})
        self.assertPosition(self.fields("teltonika-rut955", device, 1), 23.903597, 54.898521, 5)
        self.assertEqual(self.fields("teltonika-rut955", device, 2)["position"][:3], "no:")

    def test_victron_gx(self):
        device = self.start_tcp({"100": victron(-33.8688197, 151.2092955, 1, 9),
                                 "101": victron(-33.8688197, 151.2092955, 0, 2)})
        good = self.fields("victron-gx", device, 100)
        self.assertPosition(good, 151.2092955, -33.8688197, 9)
        self.assertEqual(good["satellites"], "9")
        self.assertEqual(self.fields("victron-gx", device, 101)["position"],
                         NOT_VALID)

    def test_the_guides_example(self):
        guide = (FIRMWARE / "guide" / "profiles.md").read_text()
        profile = self.folder / "float.toml"
        profile.write_text(re.search(r"```toml\n(.*?)```", guide, re.S).group(1))
        shown = re.search(r"```\n(unit 7.*?)```", guide, re.S).group(1)
        low_first = lambda value: words("i", value)[::-1]
        # As its table says: 30001 is the first input register, thousandths of a minute.
        device = self.start_tcp({"7": {"4": at(
            (100, [3]), (101, low_first(round(47.9888 * 60000))), (103, low_first(780703)),
            (109, words("h", -3500)), (110, [123]), (111, words("h", -1)))}})
        done = self.probe("--profiles", profile, "--profile", "float", "-a", 7, *device)
        self.assertEqual(done.stdout, shown)


    def test_the_profiles_of_a_gateways_configuration(self):
        config = self.folder / "gateway.toml"
        config.write_text(f"""
profiles = "{PROFILES}"
[mesh]
vertices_max = 100
[[bus]]
tcp = "127.0.0.1:1"
[[bus.device]]
units = "7"
profile = "transmitter"
[[profile]]
name = "transmitter"
[[profile.reading]]
name = "depth"
unit = "m"
value = {{ register = 5, scale = "0.1" }}
[no_key_of_a_gateway]
""")
        device = self.start_tcp({"7": {"3": {"5": 123}}, "1": teltonika(63.25, 10.5)})
        self.assertEqual(self.fields("transmitter", device, 7, config)["depth"], "12.3 m",
                         "its own takes the place of the other")
        self.assertPosition(self.fields("teltonika-rut955", device, 1, config), 10.5, 63.25, 5)
        (self.folder / "mine.toml").write_text(config.read_text().split("[no_key")[0]
                                               .split("[[profile]]", 1)[1].join(["[[profile]]", ""]))
        config.write_text('profiles = "mine.toml"\n[mesh]\n')
        self.assertEqual(self.fields("transmitter", device, 7, config)["depth"], "12.3 m",
                         "a path starts from the folder of the file")


class Refusals(ProbeCase):
    def complaint(self, *arguments, code):
        done = self.probe(*arguments, code=code)
        self.assertEqual(done.stdout, "")
        for line in done.stderr.splitlines():
            self.assertRegex(line, r"^etcm-bus: ")
        return done.stderr

    def test_a_name_that_is_not_there_names_those_that_are(self):
        said = self.complaint("--profiles", PROFILES, "--profile", "ebyte", "/dev/null/x", code=2)
        self.assertIn("--profile ebyte: no such profile in", said)
        self.assertIn("ebyte-e108, mobiltex-rmu5, teltonika-rut955, transmitter, victron-gx", said)

    def test_mistakes_of_a_profile_are_all_told_and_nothing_is_asked(self):
        (self.folder / "p.toml").write_text(
            "[[profile]]\nname = \"p\"\nlongitude = { register = 70000 }\nfunction = 9\n")
        said = self.complaint("--profiles", self.folder / "p.toml", "--profile", "p", "/dev/null/x",
                              code=2).splitlines()
        self.assertEqual(len(said), 3)
        for line in said:
            self.assertRegex(line, r"p\.toml:\d: .*; .*")

    def test_mistakes_in_a_gateways_profiles_are_told(self):
        config = self.folder / "gateway.toml"
        config.write_text("[mesh]\n[[bus]]\n[[profile]]\nname = \"p\"\nfunktion = 3\n")
        said = self.complaint("--profiles", config, "--profile", "p", "/dev/null/x", code=2)
        self.assertRegex(said, r"gateway\.toml:5: .*funktion")
        config.write_text("profiles = \"none.toml\"\n[mesh]\n")
        said = self.complaint("--profiles", config, "--profile", "p", "/dev/null/x", code=2)
        self.assertIn("none.toml", said)

    def test_a_misspelt_table_of_profiles_is_told(self):
        (self.folder / "p.toml").write_text("[[profil]]\nname = \"p\"\n")
        self.assertIn("profil", self.complaint("--profiles", self.folder / "p.toml", "--profile",
                                               "p", "/dev/null/x", code=2))

    def test_profiles_that_are_not_there_are_asked_for(self):
        self.assertIn("check the path",
                      self.complaint("--profiles", self.folder / "no", "--profile", "p",
                                     "/dev/null/x", code=2))

    def test_registers_that_a_device_does_not_have_are_its_exception(self):
        device = self.start_tcp({"1": teltonika(1, 2)})
        said = self.complaint("--profiles", PROFILES, "--profile", "victron-gx", *device, code=1)
        self.assertRegex(said, r"unit 1 on \S+: registers 2800 to 2803: exception 2: .*; .*'gap_max'")


if __name__ == "__main__":
    unittest.main(verbosity=2)
