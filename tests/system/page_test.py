"""The status page in a real browser, over a real gateway and simulated nodes.

ETCM_BIN is the programs' folder. ETCM_SCREENSHOTS, where it is set, is a folder for screenshots.
Every wait is for a condition.
"""
import json
import re
import signal
import socket
import unittest
import urllib.error
import urllib.request

from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys

from browser import BrowserCase, PageCase
from gateway_test import SOON, wait_for


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
        self.wait_for_text("#details-title", r"^(Node|Steiner vertex) \d+$")
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
        self.assertNotEqual(before.split()[1], self.text("#counts").split()[1])
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
        self.wait_for_text("#state", r"^1 node is missing: node 5, unit 5 of 127\.0\.0\.1:\d+")
        self.wait_for_text("#counts", r"Nodes\s*4")
        self.wait_for_text("#missing-title", r"^Missing \(1\)$")
        self.wait_for_text("#missed", r"Node 5unit 5, \S+, since \d\d:\d\d:\d\d \(")
        self.wait_for_text("#legend", r"Missing\s*1")
        self.assertRegex(self.text("#nodes-title"), r"\(5\)")
        # It is where it stood last, and the list leads there.
        self.find("#missed button").click()
        self.wait_for_text("#details-title", r"^Node 5$")
        self.wait_for_text("#facts", r"(?s)missing.*no answer since \d\d:\d\d:\d\d.*500, 500")
        self.screenshot("missing")
        with self.assertRaises(urllib.error.HTTPError) as ill:
            self.get("/healthz")
        self.assertEqual(ill.exception.code, 503)
        self.assertIn(b"1 node is missing: node 5", ill.exception.read())
        gateway.process.send_signal(signal.SIGHUP)
        self.wait_for_text("#state", r"^All well$")
        wait_for("no list", lambda: not self.find("#missing").is_displayed())
        self.assertEqual(self.get("/healthz"), b"ok\n")

    def test_a_bus_that_is_silent_is_shown_since_when(self):
        self.start_page(["0,1,join,0,0", "0,2,join,1000,0", "0,3,join,400,700"], **SOON)
        self.size(1280, 800)
        self.browser.get(self.url)
        self.wait_for_text("#state", r"^All well$")
        self.programs[0].process.send_signal(signal.SIGSTOP)
        self.wait_for_text("#buses", r"silent since \d\d:\d\d:\d\d \(")
        self.wait_for_text("#state", r"^Bus \S+ silent, 3 stale$|no unit has answered for")
        self.screenshot("silent")
        self.programs[0].process.send_signal(signal.SIGCONT)
        self.wait_for_text("#state", r"^All well$")
        self.assertRegex(self.text("#counts"), r"Nodes\s*3")

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
        self.wait_for_text("#lost", r"has not answered since \d")
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
        wait_for("the page again", lambda: b"etcm_nodes 3\n" in self.get("/metrics"))


if __name__ == "__main__":
    unittest.main(verbosity=2)
