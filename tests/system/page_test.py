"""The status page in a real browser, over a real gateway and simulated nodes.

ETCM_BIN is the programs' folder. ETCM_SCREENSHOTS, where it is set, is a folder for screenshots.
Every wait is for a condition.
"""
import csv
import datetime
import io
import json
import re
import signal
import socket
import struct
import unittest
import urllib.error
import urllib.request
import zlib

from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys

from browser import BrowserCase, PageCase
from gateway_test import SOON, wait_for


MOMENT = r"\d+ \w+ \d{4}, \d\d:\d\d:\d\d \S+"   # with its zone


class InABrowser(BrowserCase):
    def test_an_operator_finds_a_node(self):
        # A node in the middle of a square, one that stands on another, one that joins later.
        self.start_page_with_room(
            ["0,1,join,0,0", "0,2,join,1000,0", "0,3,join,1000,1000", "0,4,join,0,1000",
             "0,5,join,500,500", "300,6,join,0,0", "0,8,join,480,20"],
            "[[feature]]\nfrom = 1\nto = 2\n[[feature]]\nfrom = 1\nto = 3\n")
        self.size(1280, 800)
        self.browser.get(self.url)
        self.wait_for_text("#counts", r"Nodes\s*6")
        self.wait_for_text("#state", r"1 in quarantine")
        self.wait_for_text("#refused", r"(?s)Node 6.*stands exactly there")
        self.wait_for_text("#nodes-title", r"Nodes \(7\)")
        self.wait_for_text("#events", r"node 5 joined at \(500, 500\)")

        # The node in the middle of the site is in the middle of the map. While the lists beside it
        # grow the map still shrinks, and a click may miss.
        wait_for("the details of node 5", lambda: self.click_at(0, 0) or self.text(
            "#details-title") == "Node 5")
        self.wait_for_text("#facts", r"(?s)fresh.*bus\s+5, 127\.0\.0\.1:\d+.*500, 500")
        neighbours = self.text("#neighbours").split()
        self.assertGreaterEqual(len(neighbours), 3)
        self.screenshot("details")

        # Another by its neighbour, another by a search.
        self.find("#neighbours button").click()
        self.wait_for_text("#details-title", r"^(Node|Proposed relay) \d+$")
        search = self.find("#search")
        search.send_keys("8")
        self.wait_for_text("#nodes-title", r"\(1 of \d\)")
        self.find("tr.row button").click()
        self.wait_for_text("#details-title", r"^Node 8$")
        search.send_keys(Keys.ESCAPE)
        wait_for("closed details", lambda: not self.find("#details").is_displayed())
        search.clear()
        search.send_keys("quarantined")
        self.wait_for_text("#body", r"^6\s")
        search.clear()
        search.send_keys(" ")

        # Sorted by another column, and the other way round.
        self.browser.find_elements(By.CSS_SELECTOR, "#columns button")[0].click()
        self.wait_for_text("#body", r"^[78]\s")

        # A node joins while one looks.
        before = self.text("#counts")
        self.join_on_second_bus(7, 700, 250)
        self.wait_for_text("#counts", r"Nodes\s*7")
        version = r"Version \(generation\)\s*(\d+)"
        self.assertNotEqual(re.search(version, before), None)
        self.assertNotEqual(*(re.search(version, text).group(1) for text in (before, self.text("#counts"))))
        self.wait_for_text("#nodes-title", r"8")
        self.wait_for_text("#events", r"node 7 joined")
        self.assertEqual([entry for entry in self.browser.get_log("browser")
                          if entry["level"] == "SEVERE"], [])

    def test_who_is_missing_is_shown_until_it_is_dismissed(self):
        gateway = self.start_page(["0,1,join,0,0", "0,2,join,1000,0", "0,3,join,1000,1000",
                                   "0,4,join,0,1000", "0,5,join,500,500", "4000,5,silent,,"], **SOON)
        self.size(1280, 800)
        self.browser.get(self.url)
        gateway.wait_for_line(r"node 5 is missing: unit 5 of")
        self.wait_for_text("#state", r"^Major: node 5, unit 5 of 127\.0\.0\.1:\d+, is missing, since ")
        self.wait_for_text("#counts", r"Nodes\s*4")
        self.wait_for_text("#missing-title", r"^Missing \(1\)$")
        self.wait_for_text("#missed", rf"Node 5unit 5, \S+, since {MOMENT} \(")
        self.wait_for_text("#legend", r"Missing\s*1")
        self.assertRegex(self.text("#nodes-title"), r"\(5\)")
        # It is where it stood last, and the list leads there.
        self.find("#missed button").click()
        self.wait_for_text("#details-title", r"^Node 5$")
        self.wait_for_text("#facts", rf"(?s)missing.*no answer since {MOMENT}.*500, 500")
        self.screenshot("missing")
        with self.assertRaises(urllib.error.HTTPError) as ill:
            self.get("/healthz")
        self.assertEqual(ill.exception.code, 503)
        self.assertIn(b"1 node is missing: node 5", ill.exception.read())
        # It is an alarm, with the cure.
        self.wait_for_text("#alarms-title", r"^Alarms \(1\)$")
        self.wait_for_text("#alarm-list", rf"(?s)^major\s*node 5, unit 5 of \S+, is missing\s*since {MOMENT}"
                                          r".*etcm-gateway ctl dismiss 5$")
        self.assertEqual(self.ctl("acknowledge", "all").stdout, "1 acknowledged\n")
        self.wait_for_text("#alarms-title", r"^Alarms \(1\), 1 acknowledged$")
        self.find("#close").click()
        self.screenshot("alarms")
        # A reload with a mistake says so until it is mended.
        config = self.folder / "site.toml"
        good = config.read_text()
        config.write_text(good + "nonsense = 1\n")
        gateway.process.send_signal(signal.SIGHUP)
        self.wait_for_text("#alarm-list", r"(?s)the configuration was changed and is refused: .*nonsense")
        self.wait_for_text("#state", r"(?s)^Major: node 5, .*\nand 1 more alarm$")
        config.write_text(good)
        gateway.process.send_signal(signal.SIGHUP)
        self.wait_for_text("#state", r"^Major: node 5, .* is missing")
        self.assertEqual(self.ctl("dismiss", "5").returncode, 0)
        self.wait_for_text("#state", r"^All well$")
        wait_for("no list", lambda: not self.find("#missing").is_displayed())
        wait_for("no alarm", lambda: not self.find("#alarms").is_displayed())
        rows = list(csv.DictReader(io.StringIO(self.get("/alarms.csv").decode())))
        self.assertIn("node 5", rows[-1]["text"])
        self.assertEqual((rows[-1]["on"], rows[-1]["acknowledged"]), ("no", "yes"))
        self.assertEqual(self.get("/healthz"), b"ok\n")

    def test_the_guide_is_where_the_page_is(self):
        self.start_page(["0,1,join,0,0"])
        if b'href="guide"' not in self.get("/"):
            self.skipTest("built without cmark-gfm")
        self.size(1280, 800)
        self.browser.get(self.url)
        self.find('footer a[href="guide"]').click()
        self.wait_for_text("h1", r"^The operating guide$")
        wait_for("the picture", lambda: self.browser.execute_script(
            "return [...document.images].every((image) => image.naturalWidth > 0)"))
        self.find('a[href="guide/nodes.html"]').click()
        self.wait_for_text("h1", r"^What happens to a node$")
        self.screenshot("guide")
        self.find('a[href="../"]').click()
        self.wait_for_text("h1", r"^ETCM gateway$")
        # As somebody types it.
        self.browser.get(self.url + "/guide/")
        self.wait_for_text("h1", r"^The operating guide$")
        wait_for("the picture", lambda: self.browser.execute_script(
            "return [...document.images].every((image) => image.naturalWidth > 0)"))
        self.find('a[href="nodes.html"]').click()
        self.wait_for_text("h1", r"^What happens to a node$")
        self.find('a[href="README.html"]').click()
        self.wait_for_text("h1", r"^The operating guide$")
        self.find('a[href="../"]').click()
        self.wait_for_text("h1", r"^ETCM gateway$")
        self.assertEqual([entry for entry in self.browser.get_log("browser")
                          if entry["level"] == "SEVERE"], [])

    def test_what_people_call_things_is_shown_and_found(self):
        gateway = self.start_page(
            ["0,1,join,0,0", "0,2,join,1000,0", "0,3,join,1000,1000", "0,4,join,0,1000"],
            "[site]\nname = 'Harbour <east> & \"west\"'\n"
            "[[node]]\nserial = 3\nname = 'pump <b>house</b>'\n"
            "[[node]]\nunit = 4\nname = 'Tør'\n")
        self.size(1280, 800)
        self.browser.get(self.url)
        wait_for("the title", lambda: self.browser.title == 'Harbour <east> & "west" – ETCM gateway')
        self.wait_for_text("h1", r'^Harbour <east> & "west"$')
        self.wait_for_text("#events", r"node 3 'pump <b>house</b>' joined at")
        search = self.find("#search")
        search.send_keys("tør")
        self.wait_for_text("#nodes-title", r"\(1 of 4\)")
        self.find("tr.row button").click()
        self.wait_for_text("#details-title", r"^Node 4 'Tør'$")
        self.wait_for_text("#neighbours", r"3 'pump <b>house</b>'")
        config = self.folder / "site.toml"
        config.write_text(config.read_text().replace("Tør", "Gate"))
        gateway.process.send_signal(signal.SIGHUP)
        self.wait_for_text("#details-title", r"^Node 4 'Gate'$")

    def test_the_versions_of_gateways_are_shown(self):
        # Nobody listens there: the list has this one alone.
        self.start_page(["0,1,join,0,0"],
                        '[mqtt]\nbroker = "127.0.0.1:9"\nsite = "yard"\nname = "north"\n')
        self.browser.get(self.url)
        version = json.loads(self.get("/status.json"))["version"]
        self.assertRegex(version, r"^\d+\.\d+")
        self.wait_for_text("footer", rf"version {re.escape(version)}, up ")
        self.wait_for_text("#members", r"north \(this one\)\s*1 node\s*"
                                       rf"version {re.escape(version)}\s*mesh ")

    def test_a_bus_that_is_silent_is_shown_since_when(self):
        self.start_page(["0,1,join,0,0", "0,2,join,1000,0", "0,3,join,400,700"], **SOON)
        self.size(1280, 800)
        self.browser.get(self.url)
        self.wait_for_text("#state", r"^All well$")
        self.programs[0].process.send_signal(signal.SIGSTOP)
        self.wait_for_text("#buses", rf"silent since {MOMENT} \(")
        self.wait_for_text("#state", rf"^Critical: bus \S+ is silent.*, since {MOMENT}")
        self.screenshot("silent")
        self.programs[0].process.send_signal(signal.SIGCONT)
        self.wait_for_text("#state", r"^All well$")
        self.assertRegex(self.text("#counts"), r"Nodes\s*3")

    def test_units_are_listed_below_their_bus_and_found(self):
        self.start_page_with_room(["0,1,join,0,0", "0,2,join,1000,0", "0,3,join,400,700",
                                   "1500,3,silent,,"])
        self.size(1280, 800)
        self.browser.get(self.url)
        self.wait_for_text("#buses", r"2 of 3 units answer")
        self.wait_for_text("#buses", r"no connection|0 of 1 units answer|silent since")
        self.find("#buses summary").click()
        self.wait_for_text("#buses .units tbody tr:first-child",
                           r"^3\s+3\s+silent since \S.*\d %, timeout .* ago")
        self.wait_for_text("#buses .units", r"answering for .*\s0 %\s+[\d.]+ ms")
        search = self.find("#unit-search")
        search.send_keys("answering")
        wait_for("two units", lambda: len(self.browser.find_elements(
            By.CSS_SELECTOR, "#buses .units tbody tr")) == 2)
        search.clear()
        search.send_keys("nosuch")
        self.wait_for_text("#no-unit", r"^No match")
        search.clear()
        search.send_keys("1")
        wait_for("the unit by its number", lambda: re.search(r"(?m)^1\s+1\s", self.text("#buses .units")))
        self.find("#buses .units button").click()
        self.wait_for_text("#details-title", r"^Node 1$")
        self.screenshot("units")

    def test_a_click_outlives_what_changes_under_it(self):
        self.start_page(["0,1,join,0,0", "0,2,join,1000,0", "0,3,join,400,700"])
        self.size(1280, 800)
        self.browser.get(self.url)
        self.wait_for_text("#nodes-title", r"\(3\)")
        uptime = lambda: self.text("footer")
        for selector in ("tr[data-serial='2'] button", "footer a[href='healthz']"):
            pressed = self.find(selector)
            before = uptime()
            ActionChains(self.browser).click_and_hold(pressed).perform()
            wait_for("another turn of the page", lambda: uptime() != before)
            ActionChains(self.browser).release().perform()
            if selector.startswith("tr"):
                self.wait_for_text("#details-title", r"^Node 2$")
        wait_for("the page behind the link", lambda: self.browser.current_url.endswith("/healthz"))

    def test_the_map_pans_and_zooms(self):
        self.start_page(["0,1,join,0,0", "0,2,join,1000,0", "0,3,join,400,700"])
        self.size(1280, 800)
        self.browser.get(self.url)
        self.wait_for_text("#counts", r"Nodes\s*3")
        canvas = self.find("#map")
        scale = lambda: self.text("#scale")
        fitted = wait_for("a scale", scale)
        picture = self.picture()
        for _ in range(4):
            self.find("#zoom-in").click()
        wait_for("a finer scale", lambda: scale() != fitted)
        self.find("#fit").click()
        wait_for("the first scale", lambda: scale() == fitted)
        ActionChains(self.browser).drag_and_drop_by_offset(canvas, 120, 60).perform()
        self.wait_for_another_picture(picture)
        dragged = self.picture()
        canvas.send_keys(Keys.ARROW_LEFT)
        self.wait_for_another_picture(dragged)
        canvas.send_keys("+++++")
        wait_for("a finer scale by keys", lambda: scale() != fitted)
        canvas.send_keys("0")
        wait_for("the first scale by a key", lambda: scale() == fitted)
        self.browser.execute_script(
            "document.querySelector('#map').dispatchEvent(new WheelEvent('wheel',"
            "{deltaY: -900, clientX: 300, clientY: 300, cancelable: true}))")
        self.browser.execute_script(
            "for (let i = 0; i < 5; ++i) document.querySelector('#map').dispatchEvent("
            "new WheelEvent('wheel', {deltaY: -300, clientX: 300, clientY: 300}))")
        wait_for("a finer scale by the wheel", lambda: scale() != fitted)

    def test_a_gateway_that_is_gone_is_said_and_so_is_its_return(self):
        gateway = self.start_page(["0,1,join,0,0", "0,2,join,90,0"])
        self.size(1280, 800)
        self.browser.get(self.url)
        self.wait_for_text("#counts", r"Nodes\s*2")
        self.assertFalse(self.find("#lost").is_displayed())
        gateway.stop(signal.SIGKILL)
        self.wait_for_text("#lost", rf"has not answered since {MOMENT}\. What you see")
        self.wait_for_text("#state", r"No answer")
        self.screenshot("lost")
        self.assertRegex(self.text("#counts"), r"Nodes\s*2")
        address = self.url.removeprefix("http://")
        text = (self.folder / "site.toml").read_text()
        (self.folder / "site.toml").write_text(
            text.replace('[http]\nlisten = "127.0.0.1:0"', f'[http]\nlisten = "{address}"'))
        self.start("again", [gateway.process.args[0], "--config", "site.toml"])
        wait_for("no alarm", lambda: not self.find("#lost").is_displayed())
        self.wait_for_text("#counts", r"Nodes\s*2")

    def test_a_page_of_which_a_part_has_not_come_is_loaded_again(self):
        """A browser gives up what it is loading where the network changes under it."""
        self.start_page(["0,1,join,0,0", "0,2,join,90,0"])
        self.browser.execute_cdp_cmd("Network.enable", {})
        block = lambda *parts: self.browser.execute_cdp_cmd(
            "Network.setBlockedURLs", {"urls": [f"*/{part}" for part in parts]})
        self.addCleanup(self.browser.execute_cdp_cmd, "Network.disable", {})
        self.addCleanup(block)
        is_styled = "return getComputedStyle(document.querySelector('#counts')).display === 'flex'"
        for part in ("main.js", "shading.js"):
            block(part, "status.json")
            self.browser.get(self.url)
            self.wait_for_text("#lost", "Not all of this page has come from the gateway")
            block()
            self.wait_for_text("#counts", r"Nodes\s*2")
            self.assertFalse(self.find("#lost").is_displayed())
        block("style.css")
        self.browser.get(self.url)
        self.wait_for_text("#counts", r"Nodes\s*2")
        self.assertFalse(self.browser.execute_script(is_styled))
        block()
        wait_for("its style", lambda: self.browser.execute_script(is_styled))
        self.wait_for_text("#counts", r"Nodes\s*2")

    def test_it_fits_a_telephone_and_the_night(self):
        rows = [f"0,{1000 + n},join,{n * 137 % 1009},{n * n * 7 % 641}" for n in range(1, 81)]
        features = "".join(f"[[feature]]\nfrom = {a}\nto = {b}\n"
                           for a, b in ((1001, 1020), (1020, 1041), (1007, 1066)))
        self.start_page(rows, features)
        for name, width, height, colours in (("light", 1400, 860, "light"),
                                             ("dark", 1400, 860, "dark"),
                                             ("narrow", 360, 760, "light")):
            self.size(width, height, colours)
            self.browser.get(self.url)
            self.wait_for_text("#counts", r"Nodes\s*80")
            across, background = self.browser.execute_script(
                "return [document.documentElement.scrollWidth,"
                " getComputedStyle(document.body).backgroundColor]")
            self.assertEqual(across, width, "nothing sticks out")
            level = sum(int(part) for part in re.findall(r"\d+", background)[:3])
            self.assertEqual(level < 200, colours == "dark", background)
            self.screenshot(name)

    def start_analysis(self):
        """A feature with a Steiner vertex, one that is refused, links and gaps that are too long, a hole."""
        self.start_page(["0,1,join,0,0", "0,2,join,1000,0", "0,3,join,480,90", "0,4,join,500,900",
                         "0,5,join,200,-300", "0,6,join,900,-420"],
                        "[[feature]]\nfrom = 1\nto = 2\n[[feature]]\nfrom = 3\nto = 5\n"
                        "[analysis]\nradio_range = 600\nsensing_range = 200\n")
        self.size(1280, 800)
        self.browser.get(self.url)
        self.wait_for_text("#counts", r"Nodes\s*6")
        self.wait_for_text("#state", r"feature \d .*is not in the mesh")

    def test_what_is_between_nodes_is_told_and_listed(self):
        self.start_analysis()
        self.wait_for_text("#legend", r"Coverage holes\s*\d[\s\S]*Links too long\s*\d")
        # What is above the map and what is below it is one count.
        self.assertEqual(re.search(r"Proposed relays\s*(\d+)", self.text("#counts")).group(1),
                         re.search(r"Proposed relays\s*(\d+)", self.text("#legend")).group(1))
        # No feature without its ends.
        self.wait_for_text("#refused", r"Feature \d \(node \d – node \d\)")
        self.find("#found summary").click()
        kinds = {"Coverage hole": r"Nearest node", "Link too long": r"Between\s+node \d – .*\d units",
                 "Barrier gap": r"Between\s+node \d – ", "Feature \d refused": r"Why\s+\S",
                 "Proposed relay": r"Position"}
        for title, facts in kinds.items():
            button = wait_for(title, lambda: next(
                (b for b in self.browser.find_elements(By.CSS_SELECTOR, "#found-body button")
                 if re.search(title, b.text)), None))
            button.send_keys(Keys.ENTER)
            self.wait_for_text("#details-title", rf"^{title}")
            self.wait_for_text("#facts", rf"(?s){facts}")
            self.assertNotIn("undefined", self.text("#details"))
        self.screenshot("analysis")
        # The pointer finds them too: the middle of a line that is chosen is on the map.
        found = self.browser.execute_async_script("""
            const done = arguments[0];
            Promise.all([import('/items.js'), import('/model.js')]).then(async ([items, model]) => {
              const mesh = model.readMesh(await (await fetch('/mesh.json')).json());
              const kinds = {};
              for (const kind of ['gap', 'link', 'refused', 'feature', 'edge', 'hole']) {
                for (const item of items.itemsOf(mesh, kind)) {
                  const only = (layer) => layer === items.layerOfItem[kind];
                  const hit = items.itemAt(mesh, item, 1, only);
                  (kinds[kind] ??= []).push(hit !== null && items.sameItem(mesh, hit) === hit);
                }
              }
              done(kinds);
            });""")
        self.assertGreaterEqual(set(found), {"gap", "link", "refused", "feature", "edge", "hole"})
        self.assertTrue(all(all(hits) for hits in found.values()), found)

    def draw_crossing_lines(self, *vertex):
        """Two lines of a site file between nodes that cross; both may have a vertex."""
        middle = [None] if vertex else []
        line = lambda name, *serials: {
            "type": "Feature", "properties": {"name": name, "serials": [serials[0], *middle, serials[1]]},
            "geometry": {"type": "LineString", "coordinates": [
                [serials[0], 0], *([list(vertex)] if vertex else []), [serials[1], 9]]}}
        (self.folder / "site.geojson").write_text(json.dumps({"type": "FeatureCollection", "features": [
            line("main pipe", 1, 3), line("north fence", 2, 4)]}))

    def test_a_feature_that_crosses_another_says_where_and_how_both_can_be(self):
        self.draw_crossing_lines()
        gateway = self.start_page(["0,1,join,0,0", "0,2,join,1000,0", "0,3,join,1000,1000", "0,4,join,0,990"],
                                  '[site]\nfile = "site.geojson"\ncrs = "plane"\n'
                                  '[[feature]]\nname = "gate line"\nfrom = 1\nto = 1707\n')
        self.size(1280, 800)
        self.browser.get(self.url)
        self.wait_for_text("#features-title", r"^Features \(3, 2 not in the mesh\)$")
        # The one that is refused stands in the header once.
        self.wait_for_text("#state", r"not in the mesh")
        said = self.text("#state")
        self.assertEqual(len(re.findall(r"north fence", said)), 1, said)
        self.assertNotIn("quarantine", said)
        self.assertNotIn("of 3 features", said)
        # The table is open, and a person with a keyboard gets to the cure.
        self.wait_for_text("#features-body", r"(?s)3 'north fence'\s+node 2 – node 4"
                           r"\s+\d+ units\s+refused\s+it crosses feature 2 'main pipe' \(\S+\) at \(497, 497\)"
                           r"\s+in the site file give both lines a vertex there, at the same coordinates")
        self.wait_for_text("#features-body", r"(?s)1 'gate line'.*waits\s+node 1707, where it ends, has (not been heard|left)"
                                             r".*correct the serial in site\.toml:\d+, or look for the node")
        self.assertEqual(self.find("#features .units").get_attribute("tabindex"), "0")
        link = self.find("#features-body a")
        self.assertTrue(link.get_attribute("href").endswith("/guide/site.html#where-lines-meet"))
        if b'href="guide"' in self.get("/"):
            self.assertIn(b'id="where-lines-meet"', self.get("/guide/site.html"))
        button = next(b for b in self.browser.find_elements(By.CSS_SELECTOR, "#features-body button")
                      if "north fence" in b.text)
        button.send_keys(Keys.ENTER)
        self.wait_for_text("#details-title", r"^Feature 3 'north fence' refused$")
        self.wait_for_text("#facts", r"(?s)They meet at\s+\(497, 497\)")
        self.screenshot("crossing")
        self.find("#close").click()
        # By its name in the search, also of one that is in the mesh.
        search = self.find("#search")
        search.send_keys("main pi")
        self.wait_for_text("#found-features", r"^Feature 2 'main pipe'$")
        search.send_keys(Keys.ENTER)
        self.wait_for_text("#details-title", r"^Feature 2 'main pipe'$")
        self.wait_for_text("#facts", r"(?s)State\s+in the mesh.*Between\s+node 1 – node 3")
        search.clear()
        # One that waits has no place on the map, and opens itself all the same.
        button = next(b for b in self.browser.find_elements(By.CSS_SELECTOR, "#features-body button")
                      if "gate line" in b.text)
        button.send_keys(Keys.ENTER)
        self.wait_for_text("#details-title", r"^Feature 1 'gate line'$")
        self.assertEqual(self.browser.execute_script("return document.activeElement.id"), "details-title")
        wait_for("details in view", lambda: self.browser.execute_script("""
            const box = document.querySelector('#details').getBoundingClientRect();
            return box.top >= 0 && box.top < innerHeight / 2"""))
        self.wait_for_text("#facts", r"(?s)State\s+waits.*Why\s+node 1707.*What to do\s+correct the serial")
        self.screenshot("feature-waits")
        # As the cure says, at the place that it says.
        told = next(f for f in json.loads(self.get("/features.json"))["features"] if f.get("near"))
        self.draw_crossing_lines(*told["near"])
        gateway.process.send_signal(signal.SIGHUP)
        self.wait_for_text("#features-title", r"^Features \(5, 1 not in the mesh\)$")
        self.wait_for_text("#alarms-title", r"^$|^Alarms \(1\)|^Alarms \(2\)")
        wait_for("no feature refused", lambda: "north fence" not in self.text("#state"))
        # Two parts of one name are one hit.
        search.send_keys("north")
        self.wait_for_text("#found-features", r"^Feature \d 'north fence' and 1 more of this name$")
        self.assertEqual([entry for entry in self.browser.get_log("browser")
                          if entry["level"] == "SEVERE"], [])

    def test_a_setting_that_waits_for_a_restart_is_told_until_then(self):
        gateway = self.start_page(["0,1,join,0,0", "0,2,join,1000,0"])
        self.browser.get(self.url)
        self.wait_for_text("#state", r"^All well$")
        self.assertFalse(self.find("#notice").is_displayed())
        config = self.folder / "site.toml"
        good = config.read_text()
        config.write_text(good.replace("features_max = 50", "features_max = 60"))
        gateway.process.send_signal(signal.SIGHUP)
        self.wait_for_text("#notice", r"^Waits for a restart: \[mesh\] features_max\. Changed in \S*site\.toml, "
                                      r".*sudo systemctl restart etcm-gateway$")
        self.wait_for_text("#state", r"^All well$")
        self.assertRegex(self.ctl("list").stdout, r"(?s)nothing is wrong\nwaits for a restart: \[mesh\] features_max\n")
        config.write_text(good)
        gateway.process.send_signal(signal.SIGHUP)
        wait_for("no notice", lambda: not self.find("#notice").is_displayed())

    def test_names_are_on_the_map_of_a_small_screen_and_at_twice_the_size(self):
        names = "".join(f'[[node]]\nserial = {1000 + n}\nname = "well {n}"\n' for n in range(1, 13))
        self.start_page([f"0,{1000 + n},join,{n * 137 % 1009},{n * n * 7 % 641}" for n in range(1, 13)], names)
        for width, height in ((400, 800), (640, 400), (1280, 800)):
            self.size(width, height)
            self.browser.get(self.url)
            self.wait_for_text("#counts", r"Nodes\s*12")
            labels = lambda: int(self.find("#map").get_attribute("data-labels") or 0)
            wait_for(f"names at {width}", lambda: labels() >= 8)
            self.screenshot(f"labels-{width}")

    def test_a_unit_is_found_by_its_number_before_what_has_it_as_a_part(self):
        self.start_page(["0,8,join,0,0", *(f"0,{n},join,{n * 90},{n * n}" for n in range(11, 18)), "0,2018,join,400,700"])
        self.size(1280, 800)
        self.browser.get(self.url)
        self.wait_for_text("#nodes-title", r"\(9\)")
        found = lambda: [row.get_attribute("data-serial")
                         for row in self.browser.find_elements(By.CSS_SELECTOR, "tr.row")]
        search = self.find("#search")
        search.send_keys("unit 8")
        wait_for("the node at unit 8", lambda: found() == ["17"])
        search.clear()
        search.send_keys("8")
        wait_for("what is exactly 8 first", lambda: found() == ["8", "17", "2018"])
        units = self.find("#unit-search")
        units.send_keys("unit 8")
        wait_for("unit 8 alone", lambda: [row.text.split()[0] for row in self.browser.find_elements(
            By.CSS_SELECTOR, "#buses .units tbody tr")] == ["8"])

    def test_times_are_those_of_the_clock_of_the_gateway(self):
        script = self.browser.execute_cdp_cmd("Page.addScriptToEvaluateOnNewDocument", {"source":
            "const now = Date.now; Date.now = () => now() + 40 * 86400000;"})
        try:
            self.start_page(["0,1,join,0,0", "0,2,join,1000,0"])
            self.browser.get(self.url)
            self.wait_for_text("#events", MOMENT)
            shown = re.search(MOMENT, self.text("#events")).group()
            at = datetime.datetime.strptime(shown.rsplit(" ", 1)[0], "%d %b %Y, %H:%M:%S")
            self.assertLess(abs(datetime.datetime.now() - at), datetime.timedelta(days=2), shown)
        finally:
            self.browser.execute_cdp_cmd("Page.removeScriptToEvaluateOnNewDocument", script)

    def test_who_has_left_is_told_apart_from_who_is_missing(self):
        self.start_page(["0,1,join,0,0", "0,2,join,1000,0", "0,3,join,400,700", "0,4,join,500,300", "1500,4,leave,,",
                         "6000,4,silent,,"])
        self.size(1280, 800)
        self.browser.get(self.url)
        self.wait_for_text("tr[data-serial='4']", r"has left\s*said so \d+ \w+, \d\d:\d\d\b")
        self.assertRegex(self.find("tr[data-serial='4'] td:nth-child(2)").get_attribute("title"), MOMENT)
        self.wait_for_text("#legend", r"Has left\s*1")
        self.assertNotIn("Missing", self.text("#legend"))
        self.wait_for_text("#state", r"^All well$")
        before = self.picture()
        label = lambda: next(label for label in self.browser.find_elements(By.CSS_SELECTOR, "#legend label")
                             if "Has left" in label.text)
        label().click()
        self.wait_for_another_picture(before)
        label().click()
        self.find("#search").send_keys("has left", Keys.ENTER)
        self.wait_for_text("#details-title", r"^Node 4$")
        self.wait_for_text("#facts", rf"Why\s+it has said that it leaves; said so at {MOMENT}")
        colours = self.browser.execute_script("""
            const style = getComputedStyle(document.documentElement);
            return ['--map-left', '--map-missing', '--map-stale'].map((name) => style.getPropertyValue(name))""")
        self.assertEqual(len(set(colours)), 3, colours)
        self.screenshot("left")
        # Its unit is silent then, and is no trouble.
        self.find("#close").click()
        self.find("#buses summary").click()
        self.wait_for_text("#buses .units tbody tr:last-child", r"^4\s+4\s+silent since.*has left")
        self.assertEqual(self.find("#buses .units tbody tr:last-child .mark").get_attribute("class"), "mark left")

    def test_the_table_of_nodes_has_room_for_its_columns_and_for_some_rows(self):
        rows = [f"0,{1000 + n},join,{569000 + 97 * n % 1000},{7034000 + 61 * n % 800}" for n in range(1, 25)]
        self.start_page([*rows, "1500,1003,low_battery,,"], '[site]\ncrs = "EPSG:25833"\n'
                        '[[node]]\nserial = 1002\nname = "pump house north"\n')
        for width, height in ((1280, 800), (1920, 1080)):
            self.size(width, height)
            self.browser.get(self.url)
            self.wait_for_text("#alarm-list", r"low battery")
            self.wait_for_text("#body", r"E\b")
            shown = self.browser.execute_script("""
                const area = document.querySelector('#rows');
                const right = area.getBoundingClientRect().right;
                return { rows: Math.floor(area.clientHeight / 31) - 1, wide: area.scrollWidth - area.clientWidth,
                  cut: [...document.querySelectorAll('#body tr.row td:nth-child(5)')].filter((cell) =>
                    cell.scrollWidth > cell.clientWidth || cell.getBoundingClientRect().right > right + 1).length }""")
            self.assertGreaterEqual(shown["rows"], 8, (width, shown))
            self.assertEqual((shown["cut"], shown["wide"]), (0, 0), (width, shown))
            self.screenshot(f"table-{width}")

    def test_a_low_battery_has_a_sign_of_its_own(self):
        self.start_page(["0,1,join,0,0", "0,2,join,1000,0", "0,3,join,400,700", "1500,2,low_battery,,"])
        self.size(1280, 800)
        self.browser.get(self.url)
        self.wait_for_text("#alarm-list", r"^minor\s*node 2")
        self.wait_for_text("#legend", r"Low battery\s*1")
        self.wait_for_text("tr[data-serial='2']", r"fresh\s*low battery")
        self.assertNotIn("low battery", self.text("tr[data-serial='1']"))
        colours = self.browser.execute_script("""
            return ['.battery', '.mark.fresh'].map((part) =>
              getComputedStyle(document.querySelector(`tr[data-serial='2'] ${part}`)).color)""")
        self.assertNotEqual(*colours)
        before = self.picture()
        next(label for label in self.browser.find_elements(By.CSS_SELECTOR, "#legend label")
             if "Low battery" in label.text).click()
        self.wait_for_another_picture(before)
        self.screenshot("battery")

    def test_fit_leaves_out_a_node_far_from_all_others(self):
        self.start_page(["0,1,join,0,0", "0,2,join,1000,0", "0,3,join,0,1000", "0,4,join,1000,1000",
                         "0,5,join,900000,0"])
        self.browser.get(self.url)
        self.wait_for_text("#nodes-title", r"Nodes \(5\)")
        self.wait_for_text("#alarms", r"node 5, unit 5 of \S+, stands far from all others")
        bounds = self.browser.execute_async_script("""
            const done = arguments[0];
            import('/model.js').then(async ({ readMesh }) =>
              done(readMesh(await (await fetch('/mesh.json')).json()).bounds));""")
        self.assertEqual(bounds, {"left": 0, "right": 1000, "bottom": 0, "top": 1000})
        self.find("#search").send_keys("5", Keys.ENTER)
        self.wait_for_text("#facts", r"Why\s+it stands far from all others")

    def test_a_plan_lies_below_the_mesh_until_it_is_switched_off(self):
        # 20 by 10 pixels, all red: its left half lies below the nodes.
        row = b"\0" + b"\xff\0\0" * 20
        chunk = lambda kind, data: (struct.pack(">I", len(data)) + kind + data +
                                    struct.pack(">I", zlib.crc32(kind + data)))
        (self.folder / "plan.png").write_bytes(
            b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", 20, 10, 8, 2, 0, 0, 0)) +
            chunk(b"IDAT", zlib.compress(row * 10)) + chunk(b"IEND", b""))
        (self.folder / "plan.pgw").write_text("100\n0\n0\n-100\n50\n950\n")
        self.start_page(["0,1,join,0,0", "0,2,join,1000,0", "0,3,join,0,1000", "0,4,join,1000,1000"],
                        '[site]\nplan = "plan.png"\n')
        self.assertEqual(self.get("/plan"), (self.folder / "plan.png").read_bytes())
        self.assertEqual(json.loads(self.get("/status.json"))["plan"]["corners"],
                         [[0, 1000], [2000, 1000], [0, 0]])
        self.size(1280, 800)
        self.browser.get(self.url)
        self.wait_for_text("#counts", r"Nodes\s*4")
        # Between the nodes: no line goes there.
        pixel = lambda: self.browser.execute_script("""
            const canvas = document.querySelector('#map');
            return [...canvas.getContext('2d').getImageData(
              canvas.width / 2 - 60, canvas.height / 2 - 20, 1, 1).data]""")
        wait_for("the plan", lambda: pixel()[0] > 200 and pixel()[1] == 0 and pixel()[3] > 150)
        self.screenshot("plan")
        self.find("#legend label:not(.none) input").click()
        wait_for("no plan", lambda: pixel()[3] == 0)

    def test_an_anchor_says_what_it_is(self):
        (self.folder / "site.geojson").write_text(json.dumps({
            "type": "FeatureCollection", "features": [{
                "type": "Feature", "properties": {},
                "geometry": {"type": "LineString", "coordinates": [[200, 100], [700, 100]]}}]}))
        self.start_page(["0,1,join,0,0", "0,2,join,1000,0", "0,3,join,400,700"],
                        '[site]\nfile = "site.geojson"\ncrs = "plane"\n')
        self.size(1280, 800)
        self.browser.get(self.url)
        self.wait_for_text("#counts", r"Features\s*1")
        self.find("tr[data-serial='1'] button").click()
        wait_for("the anchor", lambda: next(
            (b for b in self.browser.find_elements(By.CSS_SELECTOR, "#neighbours button")
             if "anchor" in b.text), None)).click()
        self.wait_for_text("#details-title", r"^Anchor \(\d+, 100\)")
        self.wait_for_text("#facts", r"What\s+an anchor")
        self.assertNotIn("undefined", self.text("#details"))

    def test_names_on_the_map_neither_overlap_nor_are_cut(self):
        self.start_page(["0,1,join,0,0", "0,2,join,1000,0", "0,3,join,400,700"])
        self.browser.get(self.url)
        wrong = self.browser.execute_async_script("""
            const done = arguments[0];
            import('/labels.js').then(({ placeLabels }) => {
              const wrong = [];
              let placed = 0;
              let seed = 1;
              const random = (below) => (seed = seed * 16807 % 2147483647) % below;
              for (let round = 0; round < 200; ++round) {
                const [width, tall] = [300 + random(900), 200 + random(600)];
                const labels = Array.from({ length: 60 }, () => ({ x: random(width), y: random(tall),
                  radius: 5, text: 'n'.repeat(1 + random(30)) }));
                const covered = [{ left: 10, top: 10, right: 60, bottom: 150 }];
                const boxes = placeLabels(labels, covered, width, tall, (text) => 6 * text.length);
                placed += boxes.length;
                boxes.forEach((box, at) => {
                  if (box.left < 0 || box.top < 0 || box.right > width || box.bottom > tall) wrong.push(box);
                  for (const other of [...covered, ...boxes.slice(0, at)]) {
                    if (box.left < other.right && other.left < box.right && box.top < other.bottom &&
                        other.top < box.bottom) wrong.push([box, other]);
                  }
                });
              }
              done({ wrong, placed });
            });""")
        self.assertEqual(wrong["wrong"], [])
        self.assertGreater(wrong["placed"], 200 * 15)

    def test_it_works_at_twice_the_size(self):
        self.start_page([f"0,{1000 + n},join,{n * 137 % 1009},{n * n * 7 % 641}" for n in range(1, 31)])
        self.size(640, 400)
        self.browser.get(self.url)
        self.wait_for_text("#counts", r"Nodes\s*30")
        # A text that is cut, or that sticks out of what it stands in.
        cut = lambda: self.browser.execute_script("""
            return [...document.querySelectorAll('h1, h2, .chip, dt, dd, label, button, summary, a, th, li')]
              .filter((part) => part.offsetWidth > 0 && !part.matches('.unseen') && (part.scrollWidth > part.clientWidth + 1 &&
                getComputedStyle(part).display !== 'inline' ||
                !part.closest('#rows, .units') && part.getBoundingClientRect().right > innerWidth + 1))
              .map((part) => part.outerHTML.slice(0, 120))""")
        self.assertEqual(cut(), [])
        self.assertLessEqual(self.browser.execute_script("return document.documentElement.scrollWidth"), 640)
        # What was clicked on the map is told where one sees it.
        search = self.find("#search")
        search.send_keys("1007")
        search.send_keys(Keys.ENTER)
        self.wait_for_text("#details-title", r"^Node 1007$")
        self.assertEqual(cut(), [])
        self.screenshot("zoomed")

    def test_the_keyboard_finds_and_a_link_leads_to_a_node(self):
        gateway = self.start_page([f"0,{1000 + n},join,{n * 100},{n * n * 7}" for n in range(1, 6)])
        self.size(1280, 800)
        self.browser.get(self.url)
        self.wait_for_text("#nodes-title", r"\(5\)")
        search = self.find("#search")
        search.send_keys("1003", Keys.ENTER)
        self.wait_for_text("#details-title", r"^Node 1003$")
        self.assertTrue(self.browser.current_url.endswith("#node=1003"), self.browser.current_url)
        search.clear()
        search.send_keys("no such node")
        self.wait_for_text("#no-node", r"^No match")
        search.clear()
        search.send_keys("node 1004", Keys.ENTER)
        self.wait_for_text("#details-title", r"^Node 1004$")
        self.browser.refresh()
        self.wait_for_text("#details-title", r"^Node 1004$")
        self.find("#close").click()
        wait_for("no details", lambda: not self.find("#details").is_displayed())
        self.assertNotIn("#", self.browser.current_url)
        # As a colleague opens it.
        self.browser.get("about:blank")
        self.browser.get(self.url + "/#node=1002")
        self.wait_for_text("#details-title", r"^Node 1002$")
        self.assertEqual(self.find("#facts a").get_attribute("href"), self.url + "/#node=1002")
        self.browser.execute_script("location.hash = '#node=77'")
        self.wait_for_text("#no-wanted", r"^Node 77 is not known here\.$")
        self.browser.execute_script("location.hash = '#node=1005'")
        self.wait_for_text("#details-title", r"^Node 1005$")
        # When nobody answers the last picture stays.
        gateway.stop(signal.SIGKILL)
        self.wait_for_text("#lost", r"has not answered")
        self.assertEqual(self.text("#details-title"), "Node 1005")

    def test_what_the_legend_shows_is_kept(self):
        self.start_page(["0,1,join,0,0", "0,2,join,1000,0", "0,3,join,400,700"])
        self.size(1280, 800)
        edges = lambda: self.find("#legend label:not(.none) input")
        self.browser.get(self.url)
        self.wait_for_text("#legend", r"Edges\s*3")
        self.assertTrue(edges().is_selected())
        edges().click()
        self.browser.refresh()
        self.wait_for_text("#legend", r"Edges\s*3")
        self.assertFalse(edges().is_selected())
        edges().click()
        # Where the browser keeps nothing, the page is as ever.
        script = self.browser.execute_cdp_cmd("Page.addScriptToEvaluateOnNewDocument", {"source":
            "Object.defineProperty(window, 'localStorage', { get() { throw new Error('not allowed'); } })"})
        self.browser.refresh()
        self.wait_for_text("#legend", r"Edges\s*3")
        edges().click()
        self.assertFalse(edges().is_selected())
        self.browser.execute_cdp_cmd("Page.removeScriptToEvaluateOnNewDocument", script)

    def test_it_prints_all_rows_and_a_map_of_its_own(self):
        self.start_page([f"0,{1000 + n},join,{n * 137 % 1009},{n * n * 7 % 641}" for n in range(1, 121)])
        self.size(1280, 800, "dark")
        self.browser.get(self.url)
        self.wait_for_text("#counts", r"Nodes\s*120")
        seen = len(self.browser.find_elements(By.CSS_SELECTOR, "tr.row"))
        self.assertLess(seen, 100)
        whole = self.text("#scale")
        # Its text is a round number, and not another one at each step.
        for _ in range(3):
            self.find("#zoom-in").click()
        # It is drawn with the next picture.
        wait_for("a finer scale", lambda: self.text("#scale") != whole)
        before = self.text("#scale")
        self.browser.execute_script("dispatchEvent(new Event('beforeprint'))")
        self.assertEqual(len(self.browser.find_elements(By.CSS_SELECTOR, "tr.row")), 120)
        self.wait_for_text("#printed", rf"^ETCM gateway.*127\.0\.0\.1:\d+, {MOMENT}, version \(generation\) \d+")
        width, background = self.browser.execute_script(
            "return [document.querySelector('#map').width, getComputedStyle(document.body).backgroundColor]")
        self.assertGreater(width, 1900, "as fine as paper")
        self.assertGreater(sum(int(part) for part in re.findall(r"\d+", background)[:3]), 600, background)
        self.screenshot("paper")
        self.browser.execute_script("dispatchEvent(new Event('afterprint'))")
        wait_for("the page as before", lambda: len(
            self.browser.find_elements(By.CSS_SELECTOR, "tr.row")) == seen and self.text("#scale") == before)

    def test_fit_leaves_nothing_zoomed(self):
        self.start_page(["0,1,join,0,0", "0,2,join,1000,0", "0,3,join,400,700"])
        self.size(1280, 800)
        self.browser.get(self.url)
        self.wait_for_text("#counts", r"Nodes\s*3")
        zoomed = lambda: bool(self.browser.find_elements(By.CSS_SELECTOR, ".stage.zoomed"))
        self.assertFalse(zoomed())
        self.find("#zoom-in").click()
        self.assertTrue(zoomed())
        self.find("#fit").click()
        self.assertFalse(zoomed())

    def test_thousands_of_nodes_stay_smooth(self):
        count = 3000
        self.vertices_max = 2 * count
        self.interval = "1s"
        self.start_page([f"0,{n},join,{n * 7919 % 10007},{n * n % 9973}"
                         for n in range(1, count + 1)])
        self.size(1280, 800)
        self.browser.get(self.url)
        self.wait_for_text("#counts", rf"Nodes\s*{count}")
        self.wait_for_text("#nodes-title", rf"\({count}\)")
        self.assertLess(len(self.browser.find_elements(By.CSS_SELECTOR, "tr.row")), 100,
                        "only rows that are seen are made")
        self.screenshot("thousands")


class ForPrograms(PageCase):
    def test_tables_are_read_by_a_reader_of_csv(self):
        self.start_page(["0,1,join,0,0", "0,2,join,1000,0", "0,3,join,400,700"])
        self.wait_for_header(nodes=3)
        table = lambda name: list(csv.DictReader(io.StringIO(self.get(name).decode(), newline="")))
        nodes = wait_for("three nodes", lambda: (lambda rows: rows if len(rows) == 3 else None)(
            table("/nodes.csv")))
        self.assertEqual({row["serial"]: (row["x"], row["y"]) for row in nodes},
                         {"1": ("0", "0"), "2": ("1000", "0"), "3": ("400", "700")})
        self.assertEqual([row["state"] for row in table("/units.csv")], ["answering"] * 3)
        events = table("/events.csv")
        self.assertRegex(events[-1]["time"], r"^\d{4}-\d\d-\d\dT\d\d:\d\d:\d\dZ$")
        self.assertTrue(any("node 3 joined" in row["text"] for row in events))

    def metrics_or_nothing(self):
        try:
            return self.get("/metrics")
        except OSError:
            return b""

    def test_documents_are_what_they_say(self):
        self.start_page(["0,1,join,0,0", "0,2,join,1000,0", "0,3,join,400,700", "0,4,join,400,100"],
                        "[[feature]]\nfrom = 1\nto = 2\n")
        self.wait_for_header(nodes=4, features=1)
        mesh = wait_for("four nodes", lambda: (lambda m: m if sum(
            f["properties"].get("in_mesh", False) for f in m["features"]) == 4 else None)(
                json.loads(self.get("/mesh.geojson"))))
        points = {f["id"]: f for f in mesh["features"] if "id" in f}
        for point in points.values():
            for neighbour in point["properties"]["neighbours"]:
                self.assertIn(neighbour, points)
        lines = {f["properties"]["kind"]: f["geometry"]["coordinates"] for f in mesh["features"]
                 if f["geometry"] and f["geometry"]["type"] == "MultiLineString"}
        status = json.loads(self.get("/status.json"))
        self.assertEqual(len(lines["edges"]) + len(lines["features"]), status["edges"])
        self.assertEqual(len(json.loads(self.get("/ages.json"))), 4)
        self.assertIn(b"etcm_nodes 4\n", self.get("/metrics"))
        self.assertEqual(self.get("/healthz"), b"ok\n")
        with self.assertRaises(urllib.error.HTTPError) as missing:
            self.get("/../etc/passwd")
        self.assertEqual(missing.exception.code, 404)

    def test_two_hundred_connections_do_not_stop_the_polls(self):
        self.start_page_with_room(["0,1,join,0,0", "0,2,join,1000,0"])
        address = self.url.removeprefix("http://").split(":")
        crowd = []
        for number in range(200):
            client = socket.create_connection((address[0], int(address[1])), timeout=40)
            client.sendall(b"GET / HTTP/1.1\r\nX: " if number % 2 else b"")
            crowd.append(client)
        self.join_on_second_bus(3, 400, 700)
        self.wait_for_header(nodes=3)
        for client in crowd:
            client.close()
        wait_for("the page again", lambda: b"etcm_nodes 3\n" in self.metrics_or_nothing())


if __name__ == "__main__":
    unittest.main(verbosity=2)
