"""What the pages of a fleet say of its gateways, in a real browser, at a real broker.

ETCM_BIN is the programs' folder. ETCM_SCREENSHOTS, where it is set, is a folder for screenshots.
Every wait is for a condition.
"""
import re
import signal
import unittest

from browser import Looking
from fleet_test import FleetCase, grid
from page_test import MOMENT
from programs import wait_for

WEST, EAST = grid(1, 12, 0), grid(101, 12, 5000)


class FleetPage(Looking, FleetCase):
    def start_fleet(self, share_of_east="site"):
        self.start_broker()
        self.start_gateway("west", WEST)
        self.start_gateway("east", EAST, share_of_east)
        self.start_gateway("office", {})
        self.size(1280, 800)

    def colours(self):
        """Of the gateways on the list, by name; of those that have one."""
        return self.browser.execute_script("""
            return Object.fromEntries([...document.querySelectorAll('#members .swatch')].map((sample) =>
              [sample.parentElement.innerText.split(' ')[0], getComputedStyle(sample).backgroundColor]));""")

    def dots(self, colours):
        """Of each gateway, whether the map has nodes in its colour."""
        return self.browser.execute_script("""
            const map = document.querySelector('#map');
            const { data } = map.getContext('2d').getImageData(0, 0, map.width, map.height);
            const seen = new Set();
            for (let at = 0; at < data.length; at += 4) {
              seen.add(`rgb(${data[at]}, ${data[at + 1]}, ${data[at + 2]})`);
            }
            return Object.fromEntries(Object.entries(arguments[0]).map(([name, colour]) =>
              [name, seen.has(colour)]));""", colours)

    def test_all_agree_each_in_its_colour_until_one_is_killed(self):
        self.start_fleet()
        self.wait_for_agreement(["west", "east", "office"], WEST | EAST)
        for name in ("office", "west"):
            self.browser.get(self.pages[name])
            self.wait_for_text("#fleet-title", r"^Fleet site: 3 of 3 agree$")
            self.wait_for_text("#members", rf"(?m)^{name} \(this one\)")
            self.wait_for_text("#state", r"^All well$")
            self.wait_for_text("#counts", r"Nodes\s*24")
            colours = self.colours()
            self.assertEqual(colours.keys(), {"west", "east"})
            self.assertNotEqual(colours["west"], colours["east"])
            wait_for("nodes in both colours", lambda: all(self.dots(colours).values()))
        self.browser.get(self.pages["office"])
        self.wait_for_text("#members", r"(?s)east\s*12 nodes.*office \(this one\)\s*0 nodes.*west\s*12 nodes")
        meshes = re.findall(r"mesh ([0-9a-f]{8})", self.text("#members"))
        self.assertEqual((len(meshes), len(set(meshes))), (3, 1))
        self.screenshot("fleet-agrees")

        self.halt("east", signal.SIGKILL)
        self.wait_for_text("#members", rf"(?s)^\s*east\b.*gone since {MOMENT} \([\d.]+ (?:s|min)\).*office")
        self.wait_for_text("#fleet-title", r"^Fleet site: 2 of 3 agree$")
        self.wait_for_text("#state", r"2 of 3 gateways agree")
        self.assertNotIn("good", self.find("#state").get_attribute("class"))
        self.wait_for_text("#alarm-list", r"gateway east")
        self.screenshot("fleet-gone")
        self.run_gateway("east")
        self.wait_for_text("#fleet-title", r"^Fleet site: 3 of 3 agree$")
        self.wait_for_text("#state", r"^All well$")

    def test_a_gateway_without_share_is_shown_with_another_mesh_and_why(self):
        self.start_fleet(share_of_east=None)
        wait_for("the office to have all", lambda: self.places("office") == WEST | EAST)
        self.browser.get(self.pages["office"])
        self.wait_for_text("#fleet-title", r"^Fleet site: 2 of 3 agree$")
        # After two periods, for until then it can be what is on its way.
        self.wait_for_text("#members", r'its mesh has its own nodes alone, 12 of 24; set share = "site" in '
                                       r'\[mqtt\] there for the mesh of all\s*another mesh')
        self.wait_for_text("#state", r"^Critical: gateway east has another mesh\b")
        self.assertEqual(self.find("#state").get_attribute("class"), "chip critical")
        self.wait_for_text("#alarm-list", r"gateway east")
        self.screenshot("fleet-differs")


if __name__ == "__main__":
    unittest.main(verbosity=2)
