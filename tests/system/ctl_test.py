"""`etcm-gateway ctl`: what is wrong, acknowledged and dismissed over a Unix socket, over restarts,
and what a bundle for support has.

The programs' folder is in ETCM_BIN.
"""
import json
import pathlib
import re
import signal
import stat
import subprocess
import sys
import tarfile
import unittest

HERE = pathlib.Path(__file__).parent
sys.path.insert(0, str(HERE))
sys.path.insert(0, str(HERE.parent / "support"))
from gateway_test import PROGRAMS, SOON, GatewayCase
from programs import wait_for

STATE = '[state]\nfolder = "state"\ninterval = "1s"\n'


class OnTheMachine(GatewayCase):
    def tell(self, *words):
        done = self.ctl(*words)
        self.assertEqual((done.returncode, done.stderr), (0, ""), done.stdout)
        return done.stdout

    def refused(self, *words):
        done = self.ctl(*words)
        self.assertEqual((done.returncode, done.stdout), (1, ""), done.stderr)
        self.assertRegex(done.stderr, r"\Aetcm-gateway: [^\n]+\n\Z")
        return done.stderr

    def start_with_two_silent(self):
        self.gateway = self.start_gateway(
            self.start_nodes(["0,1,join,0,0", "0,2,join,1000,-5", "0,3,join,400,700",
                              "3000,1,silent,,", "3000,2,silent,,"]), STATE, **SOON)
        self.gateway.wait_for_line(r"node 1 is missing")
        self.gateway.wait_for_line(r"node 2 is missing")
        wait_for("two alarms", lambda: len(self.on()) == 2)

    def on(self):
        return {alarm["text"].split(",")[0]: alarm
                for alarm in json.loads(self.tell("list", "--json"))["alarms"] if alarm["on"]}

    def test_nothing_is_wrong(self):
        self.start_gateway(self.start_nodes(["0,1,join,0,0", "0,2,join,1000,-5"]))
        self.wait_for_header(nodes=2)
        self.assertEqual(self.tell("list"), "nothing is wrong\n")
        self.assertEqual(self.tell("show", "health"), "ok\n")
        self.assertIn("etcm_nodes 2\n", self.tell("show", "metrics"))
        self.assertEqual(json.loads(self.tell("show", "status.json"))["nodes"], 2)

    def test_only_its_own_user_may(self):
        self.start_gateway(self.start_nodes(["0,1,join,0,0"]))
        mode = (self.folder / "control").stat().st_mode
        self.assertTrue(stat.S_ISSOCK(mode))
        self.assertEqual(stat.S_IMODE(mode), 0o600)

    def test_who_is_missing_is_listed_acknowledged_and_dismissed_over_a_restart(self):
        self.start_with_two_silent()
        number = self.on()["node 1"]["number"]
        self.assertEqual(self.tell("acknowledge", str(number)),
                         f"alarm {number} is acknowledged\n")
        self.assertRegex(self.tell("list"), r"\A2 alarms, 1 not acknowledged\n")
        before = self.on()
        self.assertEqual(self.gateway.stop(), 0, self.gateway.log())
        self.assertFalse((self.folder / "control").exists())
        again = self.start("again", [PROGRAMS / "etcm-gateway", "--config", "site.toml"])
        again.wait_for_line(r"2 nodes are missing since before the restart")
        wait_for("the alarms", lambda: len(self.on()) == 2)
        after = self.on()
        for node in ("node 1", "node 2"):
            for what in ("number", "since", "acknowledged", "times"):
                self.assertEqual(after[node][what], before[node][what], what)
        self.assertEqual(self.tell("dismiss", "1", "2"),
                         "node 1 is no longer missed\nnode 2 is no longer missed\n")
        wait_for("no alarm", lambda: self.on() == {})
        self.assertEqual(len(re.findall(r"until 20\d\d-", self.tell("list", "--all"))), 2)

    def test_what_cannot_be_done_is_said(self):
        self.start_with_two_silent()
        self.assertIn("node 3 is not missing, so there is nothing to dismiss", self.refused("dismiss", "3"))
        self.assertIn("no gateway that has gone is called 'north'", self.refused("dismiss", "north"))
        self.assertIn("no alarm that is on has the number 77", self.refused("acknowledge", "77"))
        self.assertIn("is called '1 2'", self.refused("dismiss", "1 2"))
        self.assertEqual(self.ctl("dismiss", "1\n2").returncode, 2)
        for command, hint in (("dismiss", "serials, names of nodes or gateways, or all"),
                              ("acknowledge", "their numbers, or all")):
            without = self.ctl(command)
            self.assertEqual(without.returncode, 2)
            self.assertIn(f"ctl {command}: it is not said which; add {hint}, as sudo etcm-gateway ctl list",
                          without.stderr)
        self.assertEqual(len(self.on()), 2)
        self.assertEqual(self.ctl("dismiss", "1").returncode, 0)
        self.assertIn("node 1 is not known here: it was dismissed already", self.refused("dismiss", "1"))
        wait_for("one alarm less", lambda: len(self.on()) == 1)
        self.gateway.stop()
        self.assertIn("no gateway listens there: start it", self.refused("list"))

    def misread(self, *words):
        done = self.ctl(*words)
        self.assertEqual((done.returncode, done.stdout), (2, ""), done.stderr)
        self.assertRegex(done.stderr, r"\Aetcm-gateway: [^\n]+\n\Z")
        return done.stderr

    def test_a_word_that_means_nothing_is_named_with_what_was_meant(self):
        commands = "list, dismiss, acknowledge, show, bundle"
        self.assertIn(f"ctl: there is no 'lsit'; did you mean 'list'? There are {commands}", self.misread("lsit"))
        self.assertIn(f"ctl: there is no 'ack'; did you mean 'acknowledge'?", self.misread("ack", "1"))
        self.assertIn("ctl list: '--al' means nothing here; did you mean '--all'?", self.misread("list", "--al"))
        self.assertIn(f"ctl: there is no 'nonsense'; there are {commands}", self.misread("nonsense"))
        self.assertIn(f"ctl: it is not said what to do; add one of {commands}", self.misread())
        self.assertIn("ctl list: 'foo' means nothing here; take it out", self.misread("list", "foo"))
        shown = "alarms, history, health, config, metrics, features.json, status.json, units.json, " \
            "alarms.json, history.json"
        self.assertIn(f"ctl show: there is no 'helth'; did you mean 'health'? There are {shown}",
                      self.misread("show", "helth"))
        self.assertIn(f"ctl show: there is no '../state'; there are {shown}", self.misread("show", "../state"))

    def test_what_has_ended_is_listed_behind_the_rest_and_the_newest_first(self):
        self.start_with_two_silent()
        self.tell("dismiss", "1")
        wait_for("one alarm", lambda: len(self.on()) == 1)
        self.tell("dismiss", "2")
        wait_for("no alarm", lambda: self.on() == {})
        said = self.tell("list", "--all")
        self.assertRegex(said, r"\Anothing is wrong\nfirst those that are on, the worst before others; then what has "
                               r"ended, the newest before older\n")
        numbers = [int(number) for number in re.findall(r"(?m)^(\d+)  ", said)]
        self.assertEqual(numbers, sorted(numbers, reverse=True))
        self.assertEqual(len(numbers), 2)

    def test_a_gateway_that_was_killed_leaves_no_socket_in_the_way(self):
        gateway = self.start_gateway(self.start_nodes(["0,1,join,0,0"]))
        gateway.process.kill()
        gateway.process.wait()
        self.assertTrue((self.folder / "control").exists())
        again = self.start("again", [PROGRAMS / "etcm-gateway", "--config", "site.toml"])
        again.wait_for_line(r"node 1 joined")
        self.assertEqual(self.tell("list"), "nothing is wrong\n")

    def test_a_bundle_has_all_but_secrets(self):
        (self.folder / "broker.password").write_text("a secret\n")
        more = STATE + ('[mqtt]\nbroker = "127.0.0.1:1"\nsite = "yard"\nname = "north"\n'
                        'password_file = "broker.password"\n')
        self.start_gateway(self.start_nodes(["0,1,join,0,0"]), more)
        self.wait_for_header(nodes=1)
        wait_for("the state", lambda: (self.folder / "state/state").exists())
        said = self.tell("bundle", "-o", "b.tar.gz")
        self.assertTrue(said.startswith("b.tar.gz\n"), said)
        with tarfile.open(self.folder / "b.tar.gz") as archive:
            names = {name.split("/", 1)[1] for name in archive.getnames() if "/" in name}
            content = b"".join(archive.extractfile(member).read() for member in archive
                               if member.isfile())
            # Unless a service of this machine has written to its journal.
            if not [one for one in archive if one.name.endswith("/log") and one.size >= 100]:
                [missing] = [one for one in archive if one.name.endswith("/what-is-missing")]
                self.assertRegex(archive.extractfile(missing).read().decode(), r"(?m)^log: ")
        self.assertLessEqual({"settings/site.toml", "state/state", "versions", "metrics",
                              "status.json", "units.json", "history.json", "health", "alarms"}, names)
        self.assertNotIn(b"a secret", content)

    def test_a_gateway_that_hangs_is_waited_for_once(self):
        gateway = self.start_gateway(self.start_nodes(["0,1,join,0,0"]))
        gateway.process.send_signal(signal.SIGSTOP)
        self.addCleanup(gateway.process.send_signal, signal.SIGCONT)
        done = self.ctl("bundle", "--config", "site.toml", "-o", "b.tar.gz")
        self.assertEqual(done.returncode, 0, done.stderr)
        with tarfile.open(self.folder / "b.tar.gz") as archive:
            [member] = [one for one in archive if one.name.endswith("/what-is-missing")]
            missing = archive.extractfile(member).read().decode()
        for name in ("metrics", "units.json", "health"):
            self.assertRegex(missing, rf"(?m)^{name}: .*the gateway does not answer")

    def test_a_bundle_of_a_gateway_that_is_dead_says_what_is_missing(self):
        gateway = self.start_gateway(self.start_nodes(["0,1,join,0,0"]))
        gateway.stop()
        self.tell("bundle", "--config", "site.toml", "-o", "b.tar.gz")
        with tarfile.open(self.folder / "b.tar.gz") as archive:
            [member] = [one for one in archive if one.name.endswith("/what-is-missing")]
            self.assertIn("no gateway listens there", archive.extractfile(member).read().decode())
        done = self.ctl("bundle", "--config", "nowhere.toml", "-o", "no/such/folder/b.tar.gz")
        self.assertEqual((done.returncode, done.stdout), (1, ""))
        self.assertIn("no/such/folder/b.tar.gz: cannot be written", done.stderr)

    def test_a_bundle_says_when_there_is_no_folder_to_pack_it_in(self):
        done = subprocess.run([PROGRAMS / "etcm-gateway", "ctl", "bundle"], cwd=self.folder,
                              env={"TMPDIR": str(self.folder / "none")}, capture_output=True, text=True)
        self.assertEqual((done.returncode, done.stdout), (1, ""))
        self.assertEqual(done.stderr,
                         "etcm-gateway: TMPDIR is no folder; set it to one with room\n")

    def test_the_socket_is_not_taken_from_another_gateway(self):
        buses = self.start_nodes(["0,1,join,0,0"])
        self.start_gateway(buses)
        other = (self.folder / "site.toml").read_text().replace('folder = "out"', 'folder = "o2"')
        (self.folder / "other.toml").write_text(other)
        second = self.start("second", [PROGRAMS / "etcm-gateway", "--config", "other.toml"])
        second.wait_for_line(r"takes no commands: cannot listen at \S+ \(Address already in use\)")
        # Commands first: who reads that the mesh is served may give them.
        second.wait_for_line(r"serves the mesh")
        self.assertRegex(second.log(), r"(?s)takes no commands.*serves the mesh")
        second.stop()
        self.assertEqual(self.tell("list"), "nothing is wrong\n")

    def test_hostile_clients_stop_nothing(self):
        self.start_gateway(self.start_nodes(["0,1,join,0,0"]))
        script = ("import socket,sys\n"
                  "held=[]\n"
                  "for n in range(50):\n"
                  "    s=socket.socket(socket.AF_UNIX); s.settimeout(0.2)\n"
                  "    try:\n"
                  "        s.connect('control'); s.send([b'', b'x'*9000, b'\\0\\xff\\n', b'show metrics\\n'][n%4])\n"
                  "    except OSError: pass\n"
                  "    held.append(s)\n")
        subprocess.run([sys.executable, "-c", script], cwd=self.folder, check=True, timeout=60)
        self.assertEqual(self.tell("list"), "nothing is wrong\n")
        self.wait_for_header(nodes=1)


if __name__ == "__main__":
    unittest.main(verbosity=2)
