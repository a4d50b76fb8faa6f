"""A gateway that was built without the libraries that it can do without: it runs, and says of settings
that need one which that is. ETCM_BARE_GATEWAY is that program."""
import os
import subprocess
import unittest

from programs import PATIENCE_S, ProgramCase

GATEWAY = os.environ["ETCM_BARE_GATEWAY"]
PLAIN = """[mesh]
vertices_max = 100
[server]
listen = "127.0.0.1:0"
[[bus]]
name = "yard"
tcp = "127.0.0.1:1"
units = "1"
"""
MQTT = """[mqtt]
broker = "127.0.0.1"
site = "harbour"
name = "north"
"""


class Bare(ProgramCase):
    def configure(self, more=""):
        path = self.folder / "gateway.toml"
        path.write_text(PLAIN + more)
        return path

    def check(self, more):
        done = subprocess.run([GATEWAY, "--check-config", "--config", self.configure(more)],
                              capture_output=True, text=True, timeout=PATIENCE_S)
        return done.returncode, done.stderr

    def test_without_them_it_runs(self):
        self.assertEqual(self.check(""), (0, ""))
        gateway = self.start("gateway", [GATEWAY, "--config", self.configure()])
        gateway.wait_for_line("serves the mesh on ")
        self.assertEqual(gateway.stop(), 0)

    def test_what_is_missing_is_named_with_the_cure(self):
        for more, words in (
                (MQTT, "built without libmosquitto; install libmosquitto-dev and libssl-dev and "
                       "build it again, or take [mqtt] out"),
                (MQTT + 'sparkplug = "harbour"\n', "built without libmosquitto; install"),
                ('[site]\ncrs = "EPSG:25832"\n', "built without PROJ")):
            with self.subTest(more=more):
                status, said = self.check(more)
                self.assertEqual(status, 2)
                self.assertIn(words, said)
                gateway = self.start("gateway", [GATEWAY, "--config", self.folder / "gateway.toml"])
                self.assertEqual(gateway.process.wait(PATIENCE_S), 2)
                self.assertIn(words, gateway.log())

    def test_lines_of_a_board_are_told_at_the_start(self):
        gateway = self.start("gateway", [GATEWAY, "--config",
                                         self.configure('[gpio]\nstatus_led = "LED"\n')])
        self.assertEqual(gateway.process.wait(PATIENCE_S), 1)
        self.assertIn("built without libgpiod; install", gateway.log())


if __name__ == "__main__":
    unittest.main()
