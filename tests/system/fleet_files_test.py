"""The files that make-fleet makes, as they are installed, at a real Mosquitto. The programs' folder is
in ETCM_BIN."""
import json
import os
import pathlib
import re
import signal
import subprocess
import sys
import unittest
import urllib.request

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "support"))
from broker import EXAMPLES
from gateway_test import PROGRAMS, GatewayCase
from programs import PATIENCE_S, free_port, wait_for

MOSQUITTO = EXAMPLES / "mosquitto"
SITE = "water-works.2"
SETTINGS = """[mesh]
vertices_max = 100
features_max = 10
[server]
listen = "127.0.0.1:0"
[http]
listen = "127.0.0.1:0"
"""


class FleetFiles(GatewayCase):
    def make(self, *arguments):
        return subprocess.run(["sh", MOSQUITTO / "make-fleet", *arguments], cwd=self.folder,
                              capture_output=True, text=True, timeout=PATIENCE_S)

    def make_well(self, *arguments):
        done = self.make(*arguments)
        self.assertEqual((done.returncode, done.stderr), (0, ""), done.stdout)
        return done.stdout

    def install(self, machine, folder=None):
        """As install.sh does, below a folder for each machine."""
        root = self.folder / f"{machine}-root"
        done = subprocess.run(["sh", self.folder / SITE / (folder or machine) / "install.sh"],
                              env={"PATH": "/usr/bin:/bin", "DESTDIR": str(root)},
                              capture_output=True, text=True, timeout=PATIENCE_S)
        return root, done

    def install_broker(self):
        root, done = self.install("broker")
        self.assertEqual(done.returncode, 0, done.stderr)
        return root / "etc/mosquitto"

    def start_broker(self):
        self.port = free_port()
        files = self.install_broker()
        text = (files / "conf.d/etcm.conf").read_text().replace("/etc/mosquitto", str(files))
        text, count = re.subn(r"(?m)^listener 8883$", f"listener {self.port} 127.0.0.1", text)
        self.assertEqual(count, 1)
        path = self.folder / "broker.conf"
        # As root it would go on as another user, who cannot read this folder.
        path.write_text(text + f"user {'root' if os.geteuid() == 0 else 'mosquitto'}\n")
        self.broker = self.start("mosquitto", ["mosquitto", "-v", "-c", path])
        self.broker.wait_for_line("mosquitto version .* running")

    def start_member(self, name):
        root = self.folder / f"{name}-root"
        (root / "etc/etcm").mkdir(parents=True)
        settings = root / "etc/etcm/gateway.toml"
        settings.write_text(SETTINGS)
        for _ in range(2):
            # Once more changes nothing.
            _, done = self.install(name)
            self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(settings.read_text().count("[mqtt]"), 1)
        unit = (root / "etc/systemd/system/etcm-gateway.service.d/mqtt.conf").read_text()
        self.assertEqual(unit, "[Service]\nLoadCredential=mqtt.psk:/etc/etcm/mqtt.psk\n")
        # As the service has it, but for the port and for systemd.
        text = settings.read_text()
        for there, here in ((r'broker = "127.0.0.1"', f'broker = "127.0.0.1:{self.port}"'),
                            ("/run/credentials/etcm-gateway.service/mqtt.psk",
                             str(root / "etc/etcm/mqtt.psk"))):
            self.assertEqual(text.count(there), 1)
            text = text.replace(there, here)
        config = self.folder / f"{name}.toml"
        config.write_text(text)
        gateway = self.start(name, [PROGRAMS / "etcm-gateway", "--config", config])
        gateway.wait_for_line(f"connected as {re.escape(SITE)}:{name}")
        return gateway

    def agreeing(self, gateway):
        page = re.search(r"http://\S+", gateway.log()).group().rstrip("/")
        with urllib.request.urlopen(page + "/status.json", timeout=PATIENCE_S) as answer:
            fleet = json.load(answer)["fleet"]
        return sorted(member["name"] for member in fleet["members"] if member["state"] == "here")

    def publish(self, name, topic):
        key = (self.folder / SITE / name / "mqtt.psk").read_text().strip()
        done = subprocess.run(["mosquitto_pub", "-V", "mqttv5", "-h", "127.0.0.1", "-p",
                               str(self.port), "--psk", key, "--psk-identity", name, "-q", "1",
                               "-t", f"etcm/v1/{SITE}/{topic}", "-m", "{}"],
                              capture_output=True, text=True, timeout=PATIENCE_S)
        return done.stdout + done.stderr

    def test_three_gateways_and_one_more_are_a_fleet_by_what_is_installed(self):
        self.assertIn("3 gateways, north south office and broker",
                      self.make_well(SITE, "127.0.0.1", "north", "south", "office"))
        self.start_broker()
        members = {name: self.start_member(name) for name in ("north", "south", "office")}
        wait_for("the office to see all", lambda: self.agreeing(members["office"]) ==
                 ["north", "office", "south"])
        self.assertEqual(self.publish("north", "north/try"), "")
        self.assertEqual(self.publish("north", "site"), "")
        for topic in ("north/try", "site"):
            self.assertIn("Not authorized", self.publish("south", topic))
        # One more: the others keep their keys, and the site file stays with the first.
        before = (self.folder / SITE / "broker/etcm.psk").read_text()
        self.make_well(SITE, "127.0.0.1", "east")
        self.assertTrue((self.folder / SITE / "broker/etcm.psk").read_text().startswith(before))
        self.install_broker()
        self.broker.process.send_signal(signal.SIGHUP)
        members["east"] = self.start_member("east")
        wait_for("the office to see it", lambda: "east" in self.agreeing(members["office"]))
        self.assertIn("Not authorized", self.publish("east", "site"))

    def test_each_has_a_key_of_its_own_that_nobody_else_reads(self):
        self.make_well("--home-assistant", SITE, "2001:db8::1", "north", "south")
        keys = [(self.folder / SITE / name / "mqtt.psk") for name in ("north", "south")]
        texts = [key.read_text() for key in keys]
        self.assertNotEqual(*texts)
        for text in texts:
            self.assertRegex(text, r"\A[0-9a-f]{64}\n\Z")
        for path in (self.folder / SITE).rglob("*"):
            self.assertEqual(path.stat().st_mode & 0o077, 0, path)
        self.assertIn('broker = "[2001:db8::1]"\n',
                      (self.folder / SITE / "south/mqtt.toml").read_text())
        acl = (self.folder / SITE / "broker/etcm.acl").read_text()
        self.assertIn(f"\nuser north\ntopic readwrite etcm/v1/{SITE}/site\n"
                      "topic write homeassistant/device/+/config\n"
                      "user south\ntopic write homeassistant/device/+/config\n\n", acl)
        self.assertNotIn("harbour", acl)

    def test_what_is_no_fleet_is_refused(self):
        for arguments, why in ((("a b", "h", "north"), "'a b' is no name"),
                               ((SITE, "h", "x" * 33), "longer than 32"),
                               ((SITE, "h", "site"), "no gateway can be called 'site'"),
                               ((SITE, "h:8883", "north"), "leave the port out"),
                               ((SITE, "h"), "usage: make-fleet")):
            done = self.make(*arguments)
            self.assertEqual(done.returncode, 2)
            self.assertIn(why, done.stderr)
            self.assertFalse((self.folder / SITE).exists())

    def test_settings_of_another_broker_stay(self):
        self.make_well(SITE, "127.0.0.1", "north")
        settings = self.folder / "north-root/etc/etcm/gateway.toml"
        settings.parent.mkdir(parents=True)
        settings.write_text(SETTINGS + '[mqtt]\nname = "old"\n')
        _, done = self.install("north")
        self.assertEqual(done.returncode, 1)
        self.assertIn("has another [mqtt]; put the lines of", done.stderr)
        self.assertIn('name = "old"', settings.read_text())
        self.assertFalse((settings.parent / "mqtt.psk").exists())

    def test_a_bus_of_the_same_name_is_not_taken_for_the_gateways(self):
        self.make_well(SITE, "127.0.0.1", "north")
        settings = self.folder / "north-root/etc/etcm/gateway.toml"
        settings.parent.mkdir(parents=True)
        bus = '[[bus]]\nname = "north"\n'
        settings.write_text(f'[mqtt]\nsite = "{SITE}"\nname = "south"\n{bus}')
        self.assertEqual(self.install("north")[1].returncode, 1)
        settings.write_text(f'[mqtt]\n  name="north" # the yard\nsite = "{SITE}"\n{bus}')
        self.assertEqual(self.install("north")[1].returncode, 0)


if __name__ == "__main__":
    unittest.main()
