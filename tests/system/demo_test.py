"""tools/demo as a newcomer runs it, in the build of the preset release.

With ETCM_SCREENSHOTS=firmware/guide it draws two pictures of the guide (tools/pictures).
"""
import json
import pathlib
import re
import signal
import unittest
import urllib.request

from selenium.webdriver.support.ui import Select

from browser import Looking
from programs import PATIENCE_S, ProgramCase, wait_for

DEMO = pathlib.Path(__file__).resolve().parents[2] / "tools/demo"


class Live(Looking, ProgramCase):
    def tearDown(self):
        # It ends its own programs.
        for program in self.programs:
            program.stop(signal.SIGTERM)
        super().tearDown()

    def site(self, name):
        """A name of its own: its folder is not that of somebody's demo."""
        poly = self.folder / f"{name}.poly"
        poly.write_text("24 2 0 0\n" + "".join(f"{n} {n * 37 % 101} {n * n % 97}\n"
                                              for n in range(1, 25)) + "1 0\n1 1 2\n0\n")
        return poly

    def test_it_ends_with_what_came_of_it(self):
        demo = self.start("demo", [DEMO, "--poly", self.site("demo_end_test")])
        self.assertEqual(demo.process.wait(PATIENCE_S), 0, demo.log())
        self.assertRegex(demo.log(), r"(?m)^nodes +24\nfeatures +1 of 1\nproposed relays +\d+\ntriangles +\d+\n"
                                     r"generations +\d+\nconforming +yes \(audited\)\nmedian join +[\d.]+ us$")

    def test_the_map_is_where_it_says_until_it_is_interrupted(self):
        poly = self.site("demo_test")
        demo = self.start("demo", [DEMO, "--live", "--poly", poly])
        url = demo.wait_for_line(r"(?m)^live map +(.+)$").group(1)
        self.assertRegex(url, r"^http://127\.0\.0\.1:\d+$")
        page = urllib.request.urlopen(f"{url}/status.json", timeout=PATIENCE_S).read()
        self.assertTrue(page)
        demo.wait_for_line("node 5 joined")
        self.assertEqual(demo.stop(signal.SIGINT), 0, demo.log())
        self.assertFalse(re.search("error|failed", demo.log(), re.I), demo.log())

    def test_devices_are_on_a_map_in_degrees_with_what_they_measure(self):
        demo = self.start("demo", [DEMO, "--devices"])
        url = demo.wait_for_line(r"(?m)^live map +(.+)$").group(1)
        nodes = wait_for("all readings", lambda: self.nodes_with_levels(url, 12))
        self.assertEqual(len(nodes), 14)
        for node in nodes:
            longitude, latitude = node["geometry"]["coordinates"]
            self.assertTrue(10.37 < longitude < 10.42 and 63.42 < latitude < 63.44, node)
        self.size(1280, 800)
        self.browser.get(url)
        self.wait_for_text("#quantity", r"level \(m\)")
        Select(self.find("#quantity")).select_by_visible_text("level (m)")
        self.wait_for_text("#bands", r"m$")
        self.wait_for_text("#state", r"^All well$")
        self.guide_picture("devices", 128)
        self.assertEqual(demo.stop(signal.SIGINT), 0, demo.log())

    def test_a_fleet_has_one_mesh_after_a_gateway_and_the_broker_were_killed(self):
        demo = self.start("demo", [DEMO, "--fleet"])
        demo.wait_for_line(r"(?m)^4 of 4 agree: mesh_hash [0-9a-f]{16}, audited$")
        self.assertEqual(demo.process.wait(PATIENCE_S), 0)

    def test_the_office_of_a_live_fleet_shows_all_in_colours(self):
        demo = self.start("demo", [DEMO, "--fleet", "--live"])
        url = demo.wait_for_line(r"(?m)^ *[\d.]+ s +office +(\S+)$").group(1)
        demo.wait_for_line("Ctrl-C ends it")
        self.size(1280, 800)
        self.browser.get(url)
        self.wait_for_text("#fleet-title", r"^Fleet demo: 4 of 4 agree$")
        self.wait_for_text("#state", r"^All well$")
        self.assertEqual(len(self.browser.find_elements("css selector", "#members .swatch")), 3)
        self.guide_picture("fleet")
        self.assertEqual(demo.stop(signal.SIGINT), 0, demo.log())

    def nodes_with_levels(self, url, count):
        answer = urllib.request.urlopen(f"{url}/mesh.geojson", timeout=PATIENCE_S).read()
        nodes = [feature for feature in json.loads(answer)["features"]
                 if feature["properties"]["kind"] == "node"]
        levels = ["reading level (m)" in node["properties"] for node in nodes]
        return nodes if sum(levels) == count else None


if __name__ == "__main__":
    unittest.main(verbosity=2)
