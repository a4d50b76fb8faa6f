"""tools/demo as a newcomer runs it, in the build of the preset release."""
import json
import os
import pathlib
import re
import signal
import unittest
import urllib.request

from selenium.webdriver.support.ui import Select

from browser import open_browser
from programs import PATIENCE_S, ProgramCase, wait_for

DEMO = pathlib.Path(__file__).resolve().parents[2] / "tools/demo"


class Live(ProgramCase):
    def tearDown(self):
        # It ends its own programs.
        for program in self.programs:
            program.stop(signal.SIGTERM)
        super().tearDown()

    def test_the_map_is_where_it_says_until_it_is_interrupted(self):
        # A name of its own: its folder is not that of somebody's demo.
        poly = self.folder / "demo_test.poly"
        poly.write_text("24 2 0 0\n" + "".join(f"{n} {n * 37 % 101} {n * n % 97}\n"
                                              for n in range(1, 25)) + "1 0\n1 1 2\n0\n")
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
        folder = os.environ.get("ETCM_SCREENSHOTS")
        if folder:
            self.take_picture(url, pathlib.Path(folder))
        self.assertEqual(demo.stop(signal.SIGINT), 0, demo.log())

    def test_a_fleet_has_one_mesh_after_a_gateway_and_the_broker_were_killed(self):
        demo = self.start("demo", [DEMO, "--fleet"])
        demo.wait_for_line(r"(?m)^4 of 4 agree: mesh_hash [0-9a-f]{16}, audited$")
        self.assertEqual(demo.process.wait(PATIENCE_S), 0)

    def nodes_with_levels(self, url, count):
        answer = urllib.request.urlopen(f"{url}/mesh.geojson", timeout=PATIENCE_S).read()
        nodes = [feature for feature in json.loads(answer)["features"]
                 if feature["properties"]["kind"] == "node"]
        levels = ["reading level (m)" in node["properties"] for node in nodes]
        return nodes if sum(levels) == count else None

    def take_picture(self, url, folder):
        browser = open_browser()
        self.addCleanup(browser.quit)
        browser.set_window_size(1280, 800)
        browser.get(url)
        choice = browser.find_element("id", "quantity")
        wait_for("the quantities", lambda: "level (m)" in choice.text)
        Select(choice).select_by_visible_text("level (m)")
        wait_for("the levels", lambda: browser.find_element("id", "bands").text)
        browser.save_screenshot(str(folder / "devices.png"))


if __name__ == "__main__":
    unittest.main(verbosity=2)
