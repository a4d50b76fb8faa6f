"""The package on a machine that systemd has booted (machine.py): the service shut in as on a site,
watched, reloaded, killed, upgraded and removed.

The machine's root is in ETCM_MACHINE, made by make_machine.
"""
import json
import os
import pathlib
import re
import shutil
import sys
import unittest

import package_test
from machine import CannotBoot, Machine
from programs import ProgramCase, wait_for

ROOT = pathlib.Path(os.environ["ETCM_MACHINE"])
SETTINGS = pathlib.Path("/etc/etcm/gateway.toml")
SERVICE = "etcm-gateway"
ERROR, WARNING, INFORMATION = "3", "4", "6"
ALL_STALE = 2
NODES = "time_ms,serial,event,x,y\n0,1,join,0,0\n0,2,join,900,0\n0,3,join,400,700\n"
POLL = """
[mesh]
vertices_max = 100
features_max = 10
[poll]
interval = "100ms"
stale_after = "1s"
leave_after = "10min"
[state]
folder = "/var/lib/etcm/state"
interval = "1s"
"""
TCP = '[[bus]]\nname = "yard"\ntcp = "127.0.0.1:1500"\nunits = "1-3"\n'
FENCE = "[[feature]]\nfrom = 1\nto = 2\n"

setUpModule = package_test.setUpModule


class OnAMachine(ProgramCase):
    def setUp(self):
        super().setUp()
        self.machine = Machine(ROOT, self.folder)
        self.addCleanup(self.machine.stop)
        self.run_there = self.machine.run

    def install(self, package=None):
        there = self.folder / "package.deb"
        shutil.copyfile(package or package_test.GATEWAY, there)
        self.run_there("dpkg", "--force-confdef", "-i", there)

    def write(self, path, text):
        there = self.folder / "text"
        there.write_text(text)
        self.run_there("install", "-D", "-m", "644", there, path)

    def start_nodes(self, *where):
        (self.folder / "nodes.csv").write_text(NODES)
        nodes = self.start("nodes", self.machine.command(
            "etcm-nodes", *where, "--nodes", self.folder / "nodes.csv"))
        nodes.wait_for_line("ready:")

    def restart_with(self, settings):
        self.write(SETTINGS, settings)
        self.run_there("systemctl", "restart", SERVICE)

    def property_of_service(self, name):
        return self.run_there("systemctl", "show", "--value", "-p", name, SERVICE).strip()

    def process(self):
        return self.property_of_service("MainPID")

    def journal(self):
        """[(priority, line)] of the service, in order."""
        text = self.run_there("journalctl", "--sync") + self.run_there(
            "journalctl", "-u", SERVICE, "-o", "json", "--output-fields=PRIORITY,MESSAGE")
        return [(entry["PRIORITY"], entry["MESSAGE"]) for entry in map(json.loads, text.splitlines())]

    def wait_for_entry(self, priority, pattern):
        wait_for(f"'{pattern}' with priority {priority} in the journal", lambda: [
            line for found, line in self.journal()
            if found == priority and re.search(pattern, line)])

    def wait_for_mesh(self, nodes, state, features=0):
        def is_so():
            # Nobody answers while it restarts.
            text = self.run_there("sh", "-c", "etcm-bus read -t 3 -c 20 127.0.0.1:1502 || true")
            words = [int(value) for value in re.findall(r"^ +\d+ +(\d+)$", text, re.M)]
            return words and (words[11], words[19], words[4]) == (nodes, features, state)
        wait_for(f"{nodes} nodes, {features} features, state {state}", is_so)

    def test_it_collects_shut_in_and_what_it_says_has_its_priority(self):
        self.install()
        self.assertEqual(self.property_of_service("ActiveState"), "active")
        self.assertEqual(self.property_of_service("Type"), "notify")
        self.wait_for_entry(INFORMATION, r"^serves the mesh on 127.0.0.1:1502")
        # As it is installed it asks nobody, and the only thing to be told is that.
        self.wait_for_entry(WARNING, r"there is no \[\[bus\]\], so nobody is asked")

        self.start_nodes("--listen", "127.0.0.1:1500")
        self.write(SETTINGS, self.run_there("cat", SETTINGS) + TCP)
        self.run_there("systemctl", "restart", SERVICE)
        self.wait_for_mesh(nodes=3, state=0)
        wait_for("3 nodes in what systemd shows", lambda: re.search(
            "3 nodes, 0 stale, 0 missing, 0 refused", self.property_of_service("StatusText")))
        # Exposure at most 1.5, in tenths.
        self.run_there("systemd-analyze", "security", "--no-pager", "--threshold=15", SERVICE)
        status = self.run_there("cat", f"/proc/{self.process()}/status")
        self.assertRegex(status, r"(?s)Uid:\s+[1-9].*CapEff:\s+0+\n.*NoNewPrivs:\s+1.*Seccomp:\s+2")
        self.assertIn("mesh.svg", self.run_there("ls", "/var/lib/etcm/mesh"))

    def test_a_reload_takes_over_what_is_right_and_says_what_is_wrong(self):
        self.install()
        self.start_nodes("--listen", "127.0.0.1:1500")
        self.restart_with(POLL + TCP)
        self.wait_for_mesh(nodes=3, state=0)
        before = self.process()
        self.write(SETTINGS, POLL + TCP + FENCE)
        self.run_there("systemctl", "reload", SERVICE)
        self.wait_for_mesh(nodes=3, features=1, state=0)

        self.write(SETTINGS, POLL + TCP + FENCE.replace("to = 2", "to = 1"))
        self.run_there("systemctl", "reload", SERVICE)
        self.wait_for_entry(ERROR, rf"{SETTINGS}:\d+: ")
        self.wait_for_mesh(nodes=3, features=1, state=0)
        self.assertEqual(self.process(), before)
        self.assertEqual(self.property_of_service("ActiveState"), "active")

    def test_stopped_or_killed_it_comes_back_with_its_mesh(self):
        self.install()
        # The watchdog's time is on real clocks; its 30 s are long for a test.
        self.write(f"/etc/systemd/system/{SERVICE}.service.d/override.conf",
                   "[Service]\nWatchdogSec=8s\nRestartSec=1s\n")
        self.run_there("systemctl", "daemon-reload")
        self.start_nodes("--listen", "127.0.0.1:1500")
        self.restart_with(POLL + TCP)
        self.wait_for_mesh(nodes=3, state=0)
        self.wait_for_saved_state()
        # Nobody answers: what is served is what was saved.
        self.run_there("sh", "-c", "kill -STOP $(pidof etcm-nodes)")
        self.run_there("systemctl", "kill", "-s", "KILL", SERVICE)
        self.wait_for_entry(INFORMATION, r"^restored the mesh of generation \d+: 3 of 3 nodes")
        self.wait_for_mesh(nodes=3, state=ALL_STALE)

        first = self.process()
        self.run_there("systemctl", "kill", "-s", "STOP", SERVICE)
        self.wait_for_entry(ERROR, "Watchdog timeout")
        wait_for("a new process", lambda: self.process() not in ("0", first))
        self.wait_for_mesh(nodes=3, state=ALL_STALE)
        self.run_there("sh", "-c", "kill -CONT $(pidof etcm-nodes)")
        self.wait_for_mesh(nodes=3, state=0)

    def wait_for_saved_state(self):
        """Until what is published is what a start would restore."""
        def is_saved():
            at = self.run_there("stat", "-c", "%Y", "/var/lib/etcm/state/state").strip()
            now = self.run_there("date", "+%s").strip()
            return int(now) - int(at) > 3
        wait_for("a state with nothing to add", is_saved)

    def test_wrong_settings_end_it_for_good_and_the_journal_says_why(self):
        self.install()
        self.write(SETTINGS, POLL + TCP + "colour = 1\n")
        self.run_there("systemctl", "restart", SERVICE, code=1)
        self.assertEqual(self.property_of_service("ActiveState"), "failed")
        self.assertEqual(self.property_of_service("NRestarts"), "0")
        self.wait_for_entry(ERROR, rf"{SETTINGS}:\d+: .*colour")
        self.restart_with(POLL + TCP)
        self.assertEqual(self.property_of_service("ActiveState"), "active")

    def test_a_serial_line_and_a_device_that_it_may_not_open(self):
        self.install()
        self.start_nodes("--rtu", "/run/line")
        line = self.run_there("readlink", "-f", "/run/line").strip()
        # What udev does with a serial port.
        self.run_there("chgrp", "dialout", line)
        self.run_there("chmod", "660", line)
        # Of a driver that the service file does not name.
        self.run_there("mknod", "-m", "666", "/dev/ttyXR0", "c", "10", "229")
        self.restart_with(POLL + '[[bus]]\nname = "yard"\nrtu = "/run/line"\nunits = "1-3"\n'
                          '[[bus]]\nname = "odd"\nrtu = "/dev/ttyXR0"\nunits = "1"\n')
        self.wait_for_mesh(nodes=3, state=0)
        self.wait_for_entry(WARNING, r"^bus odd: /dev/ttyXR0: Operation not permitted; .*DeviceAllow")
        # As the operating guide says.
        self.write(f"/etc/systemd/system/{SERVICE}.service.d/override.conf",
                   "[Service]\nDeviceAllow=char-misc rw\n")
        self.run_there("systemctl", "daemon-reload")
        self.run_there("systemctl", "restart", SERVICE)
        self.wait_for_entry(WARNING, r"^bus odd: /dev/ttyXR0: is a device, and no serial port")

    def test_upgraded_removed_and_purged(self):
        before = self.run_there("sh", "-c", "cat /etc/passwd; systemctl list-unit-files; "
                                "find /etc /run/systemd /var/lib -path /var/lib/dpkg -prune -o "
                                "-path /run/systemd/journal -prune -o -name 'etcm*' -print")
        self.install(package_test.with_version(self.folder, "0.0.1"))
        self.write(SETTINGS, POLL + TCP)
        self.run_there("systemctl", "restart", SERVICE)
        old = self.process()
        self.install()
        self.assertEqual(self.property_of_service("ActiveState"), "active")
        self.assertNotEqual(self.process(), old)
        self.assertEqual(self.run_there("cat", SETTINGS), POLL + TCP)
        self.run_there("test", "-f", "/var/lib/etcm/state/state")

        # Who has stopped and disabled it finds it so after an upgrade.
        self.run_there("systemctl", "disable", "--now", SERVICE)
        self.install(package_test.with_version(self.folder, "9.9.9"))
        self.assertEqual(self.property_of_service("ActiveState"), "inactive")
        self.run_there("systemctl", "enable", "--now", SERVICE)

        self.run_there("dpkg", "-r", SERVICE)
        self.assertEqual(self.property_of_service("ActiveState"), "inactive")
        self.run_there("test", "-f", "/var/lib/etcm/state/state")
        self.run_there("dpkg", "-P", SERVICE)
        self.assertEqual(self.run_there(
            "sh", "-c", "cat /etc/passwd; systemctl list-unit-files; "
            "find /etc /run/systemd /var/lib -path /var/lib/dpkg -prune -o "
            "-path /run/systemd/journal -prune -o -name 'etcm*' -print"), before)
        self.assertEqual(self.run_there("systemctl", "is-system-running").strip(), "running")


def why_not():
    if os.geteuid() != 0:
        return "needs root"
    if not ROOT.is_dir():
        return f"needs {ROOT}; make it by tests/package/make_machine {ROOT}"
    try:
        with package_test.tempfile.TemporaryDirectory(prefix="etcm_machine_") as folder:
            Machine(ROOT, folder).stop()
    except CannotBoot as error:
        return str(error)
    return None


if __name__ == "__main__":
    if why := why_not():
        print(f"{why}; skipped")
        sys.exit(package_test.SKIPPED)
    unittest.main(verbosity=2, defaultTest="OnAMachine")
