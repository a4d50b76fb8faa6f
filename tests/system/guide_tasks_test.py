"""The guide is followed: its commands as they stand there, on folders of this test in place of those
of the machine.

ETCM_BIN is the programs' folder. Every wait is for a condition.
"""
import http.client
import json
import os
import pathlib
import re
import shutil
import signal
import stat
import subprocess
import unittest
from urllib.parse import urlsplit

from gateway_test import PROGRAMS, SOON, GatewayCase
from programs import PATIENCE_S, free_port, wait_for

GUIDE = pathlib.Path(__file__).resolve().parents[2] / "firmware" / "guide"
TASKS = ["A unit is silent", "A battery is low", "A feature is not in the mesh", "Replace a node",
         "Let a browser in"]
STEPS_MAX = 4
# This machine has all of 127.0.0.0/8.
COLLEAGUE = "127.0.0.2"
# What the machine has and this test must not use: each is told to the test in `asked`.
STAND_INS = {
    "sudo": 'exec "$@"\n',
    "sudoedit": 'echo "sudoedit $*" >> "$ASKED"\n',
    "systemctl": 'echo "systemctl $*" >> "$ASKED"\n',
    "hostname": "echo 127.0.0.1\n",
    "etcm-gateway": 'word=$1; [ "$word" = ctl ] && { shift; set -- ctl --socket "$SOCKET" "$@"; }\n'
                    'exec "$GATEWAY" "$@"\n',
}


def section_of(page, title):
    """What stands below a heading of the second degree."""
    return re.search(rf"^## {re.escape(title)}\n(.*?)(?=^## |\Z)", (GUIDE / page).read_text(),
                     re.M | re.S).group(1)


def commands_of(text):
    blocks = re.findall(r"^( *)```\n(.*?)^ *```\n", text, re.M | re.S)
    return [line.strip() for _, block in blocks for line in block.splitlines()]


class GuideAtItsStart(unittest.TestCase):
    def test_the_five_tasks_come_first_in_a_few_numbered_steps_each(self):
        text = (GUIDE / "README.md").read_text()
        self.assertEqual(re.findall(r"^## (.*)$", text, re.M)[:len(TASKS)], TASKS)
        self.assertLess(text.index("## " + TASKS[0]), 700)
        for task in TASKS:
            section = section_of("README.md", task)
            steps = re.findall(r"^(\d)\. ", section, re.M)
            self.assertEqual(steps, [str(n + 1) for n in range(len(steps))], task)
            self.assertTrue(3 <= len(steps) <= STEPS_MAX, task)
            self.assertTrue(commands_of(section), task)
            self.assertNotIn("](", section, f"{task}: nothing has to be read elsewhere")
            outside = re.sub(r"^( +```.*?^ +```|\d\. .*|   \S.*)$", "", section, flags=re.M | re.S)
            self.assertEqual(outside.strip(), "", task)


    def test_the_page_leads_to_each_of_them(self):
        page = (GUIDE.parent / "status/page/index.html").read_text()
        leads = set(re.findall(r'href="guide#([^"]+)"', page))
        self.assertEqual(leads, {task.lower().replace(" ", "-") for task in TASKS})


class FollowedGuide(GatewayCase):
    def setUp(self):
        super().setUp()
        self.bin = self.folder / "stand-ins"
        self.bin.mkdir()
        for name, script in STAND_INS.items():
            (self.bin / name).write_text("#!/bin/bash\n" + script)
            (self.bin / name).chmod(stat.S_IRWXU)
        self.etc = self.folder / "etc/etcm"
        self.etc.mkdir(parents=True)
        self.config = self.etc / "gateway.toml"
        self.state = self.folder / "var/lib/private/etcm"
        self.asked = self.folder / "asked"
        self.gateway = None

    def serve(self, rows, more="", **times):
        """A gateway whose settings are where the guide has them, and which can start again there."""
        self.http_port = free_port()
        self.start_gateway(self.start_nodes(rows), wait=False, **times).stop()
        self.config.write_text((self.folder / "site.toml").read_text().replace(
            'socket = "control"', f'socket = "{self.folder}/control"') +
            f'[http]\nlisten = "127.0.0.1:{self.http_port}"\nallow = ["127.0.0.1"]\n\n'
            f'[state]\nfolder = "{self.state}"\ninterval = "1s"\n' + more)
        self.begin()

    def begin(self):
        self.gateway = self.start("gateway", [PROGRAMS / "etcm-gateway", "--config", self.config])
        self.gateway.wait_for_line(r"shows the status page on")

    def follow(self, command, replaced=None):
        """What a shell says to it. `replaced`: what stands there as an example, and what is so here."""
        for there, here in {"/etc/etcm": str(self.etc), "/var/lib/private/etcm": str(self.state),
                            **(replaced or {})}.items():
            command = command.replace(there, here)
        self.asked.write_text("")
        done = subprocess.run(
            ["bash", "-c", command], cwd=self.folder, capture_output=True, text=True,
            timeout=PATIENCE_S,
            env={**os.environ, "PATH": f"{self.bin}:{os.environ['PATH']}", "ASKED": str(self.asked),
                 "SOCKET": str(self.folder / "control"), "GATEWAY": str(PROGRAMS / "etcm-gateway")})
        self.assertEqual(done.returncode, 0, f"{command}\n{done.stdout}{done.stderr}")
        for line in self.asked.read_text().splitlines():
            program, verb, *_ = line.split()
            if program == "systemctl":
                self.do(verb)
        return done.stdout

    def do(self, verb):
        if verb == "reload":
            said = self.gateway.log().count("read again")
            self.gateway.process.send_signal(signal.SIGHUP)
            wait_for("the reload", lambda: self.gateway.log().count("read again") > said)
        if verb in ("stop", "restart") and self.gateway is not None:
            self.gateway.stop()
        if verb in ("start", "restart"):
            self.begin()

    def on(self):
        return [alarm for alarm in json.loads(self.ctl("list", "--json").stdout)["alarms"]
                if alarm["on"]]

    def ask(self, path, source="127.0.0.1"):
        connection = http.client.HTTPConnection("127.0.0.1", self.http_port, timeout=PATIENCE_S,
                                                source_address=(source, 0))
        connection.request("GET", path)
        answer = connection.getresponse()
        text = answer.read().decode()
        connection.close()
        return answer.status, text

    def test_a_silent_unit_is_named_with_since_when_and_dismissed(self):
        self.serve(["0,1002,join,1000,-5", "0,1003,join,0,0", "3000,1003,silent,,"], **SOON)
        self.gateway.wait_for_line(r"node 1003 is missing")
        wait_for("the alarm", self.on)
        show, dismiss = commands_of(section_of("README.md", "A unit is silent"))
        self.assertRegex(self.follow(show), r"(?s)node 1003, unit 2 of .*is missing\n.*since 20\d\d-")
        self.assertEqual(self.follow(dismiss), "node 1003 is no longer missed\n")
        wait_for("no alarm", lambda: not self.on())

    def test_a_low_battery_is_found_and_acknowledged(self):
        self.serve(["0,1002,join,1000,-5", "0,1003,join,0,0", "1000,1003,low_battery,,"])
        wait_for("the alarm", self.on)
        show, acknowledge = commands_of(section_of("README.md", "A battery is low"))
        line = self.follow(show)
        self.assertRegex(line, r"^\d+  minor  node 1003, unit 2 of .* has a low battery\n$")
        number = line.split()[0]
        self.assertEqual(self.follow(acknowledge, {" 12": f" {number}"}),
                         f"alarm {number} is acknowledged\n")

    def test_a_feature_that_is_refused_says_why_and_is_mended(self):
        self.serve(["0,1,join,0,0", "0,2,join,1000,1000", "0,3,join,0,1000", "0,4,join,1000,0"],
                   "[[feature]]\nfrom = 1\nto = 2\n[[feature]]\nfrom = 3\nto = 4\n")
        wait_for("the alarm", self.on)
        show, find, check = commands_of(section_of("README.md", "A feature is not in the mesh"))
        self.assertRegex(self.follow(show), r'^\{"feature":2,.*"why":"it crosses feature 1 .*"cure":"[^"]')
        self.assertIn("gateway.toml", self.follow(find))
        self.config.write_text(self.config.read_text().replace("from = 3\n", "from = 1\n"))
        self.assertIn("good", self.follow(check))
        wait_for("both in the mesh", lambda: not self.on())

    def test_a_replaced_node_is_written_where_the_old_one_was(self):
        self.serve(["0,1002,join,1000,-5", "0,1003,join,0,0", "3000,1003,silent,,",
                    "4000,1053,join,10,0"], "[[feature]]\nfrom = 1002\nto = 1003\n", **SOON)
        self.gateway.wait_for_line(r"node 1003 is missing")
        wait_for("the alarm", self.on)
        show, find, check, dismiss, look = commands_of(section_of("README.md", "Replace a node"))
        self.assertIn("node 1003", self.follow(show))
        self.assertRegex(self.follow(find), rf"^{self.config}:\d+:to = 1003\n$")
        self.config.write_text(self.config.read_text().replace("1003", "1053"))
        self.assertIn("good", self.follow(check))
        wait_for("the feature", lambda: json.loads(self.ask("/status.json")[1])["features_active"] == 1)
        self.assertIn("no longer missed", self.follow(dismiss))
        wait_for("nothing to do", lambda: "nothing is wrong" in self.follow(look))

    def test_a_browser_that_is_let_in_finds_the_page_at_the_same_port(self):
        self.serve(["0,1,join,0,0", "0,2,join,1000,-5"])
        listen, restart, addresses, show, edit, reload = commands_of(
            section_of("README.md", "Let a browser in"))
        before = self.config.read_text()
        self.follow(listen)
        self.assertEqual(self.config.read_text(),
                         before.replace(f'listen = "127.0.0.1:{self.http_port}"',
                                        f'listen = "0.0.0.0:{self.http_port}"'))
        self.follow(restart)
        self.assertTrue(self.follow(addresses))
        self.assertIn(f'"0.0.0.0:{self.http_port}"', self.follow(show))
        status, text = self.ask("/", COLLEAGUE)
        self.assertEqual(status, 403)
        self.assertIn(f"does not show its page to {COLLEAGUE}", text)
        allow = re.search(r"^ +(allow = .*)$", text, re.M).group(1)
        self.follow(edit)
        self.assertIn(f"sudoedit {self.config}", self.asked.read_text())
        self.config.write_text(self.config.read_text().replace('allow = ["127.0.0.1"]', allow))
        self.follow(reload)
        wait_for("the page", lambda: self.ask("/", COLLEAGUE)[0] == 200)

    def test_settings_and_state_come_back_from_a_backup(self):
        self.serve(["0,1002,join,1000,-5", "0,1003,join,0,0", "3000,1003,silent,,"], **SOON)
        self.gateway.wait_for_line(r"node 1003 is missing")
        [before] = wait_for("the alarm", self.on)
        back_up, restore = re.findall(r"^```\n(.*?)^```", section_of("ctl.md", "Backup"), re.M | re.S)
        said = [self.follow(command) for command in back_up.splitlines()]
        self.assertNotIn("there is no state", "".join(said))
        for path in (self.config, self.state / "state"):
            self.assertRegex(said[-1], rf"(?m)^{str(path)[1:]}$")
        self.gateway.stop()
        shutil.rmtree(self.folder / "etc")
        shutil.rmtree(self.state)
        self.gateway = None
        for command in restore.splitlines():
            self.follow(command)
        self.gateway.wait_for_line(r"1 node is missing since before the restart: node 1003")
        [after] = wait_for("the alarm", self.on)
        self.assertEqual([after[key] for key in ("number", "since", "text")],
                         [before[key] for key in ("number", "since", "text")])


if __name__ == "__main__":
    unittest.main(verbosity=2)
