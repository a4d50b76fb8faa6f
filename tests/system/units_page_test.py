"""What the page says of units and of what their nodes say of themselves, in a real browser.

ETCM_BIN is the programs' folder. ETCM_SCREENSHOTS, where it is set, is a folder for screenshots.
Every wait is for a condition.
"""
import json
import re
import signal
import time
import unittest

from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys

from browser import BrowserCase
from gateway_test import PROGRAMS, SOON, wait_for
from page_test import MOMENT

STATE = '[state]\nfolder = "state"\ninterval = "1s"\n'


class Units(BrowserCase):
    def rows(self):
        return [row.text for row in self.browser.find_elements(By.CSS_SELECTOR, "#buses .units tbody tr")]

    def test_after_a_restart_who_needs_somebody_comes_first(self):
        buses = self.start_nodes([f"0,{n},join,{n * 100},{n * n * 20}" for n in (1, 2, 3, 4)] +
                                 ["3000,3,silent,,"])
        names = '[[node]]\nunit = 9\nname = "deep well"\n'
        gateway = self.start_gateway(buses, '[[bus.device]]\nunits = "9"\n' + names + STATE + self.HTTP, **SOON)
        gateway.wait_for_line(r"node 3 is missing")
        self.assertEqual(gateway.stop(), 0)
        stopped = time.monotonic()
        self.programs[0].stop()
        # Else unit 2, which answered until then, is silent since the start as good as before it.
        wait_for("some seconds", lambda: time.monotonic() - stopped > 3)
        # Unit 2 does not answer after the restart, and unit 4 for a while.
        self.start_nodes(["0,1,join,100,20", "0,4,unit,4,", "0,4,join,400,320", "4000,4,silent,,"], buses[0][0], "later")
        again = self.start("again", [PROGRAMS / "etcm-gateway", "--config", "site.toml"])
        self.url = again.wait_for_line(r"status page on (http://\S+)").group(1)
        again.wait_for_line(r"node 4 is missing")
        again.wait_for_line(r"node 2 is missing")
        self.size(1280, 800)
        self.browser.get(self.url)
        self.wait_for_text("#buses", r"1 of 5 units answer")
        self.find("#buses summary").click()
        wait_for("five units", lambda: len(self.rows()) == 5)
        rows = self.rows()
        self.assertRegex(rows[0], rf"^4\s+4\s+silent since {MOMENT} \([\d.]+ s\)")
        # That one answered until the gateway ended.
        self.assertRegex(rows[1], rf"^2\s+2\s+silent since {MOMENT} \([\d.]+ s\)")
        self.assertRegex(rows[2], rf"^3\s+3\s+silent since {MOMENT} \([\d.]+ s\)")
        self.assertRegex(rows[3], rf"^9\s+'deep well'\s+has not answered since the start, {MOMENT}")
        self.assertRegex(rows[4], r"^1\s+1\s+answering for")
        self.find("#bus-list").location_once_scrolled_into_view
        self.screenshot("units-restart")
        # By the name of the unit, which nobody has answered at.
        self.find("#unit-search").send_keys("deep w")
        wait_for("the unit", lambda: [row[0] for row in self.rows()] == ["9"])

    def test_since_when_a_unit_is_silent_is_the_same_everywhere_after_a_restart(self):
        buses = self.start_nodes([f"0,{n},join,{n * 100},{n * n * 20}" for n in (1, 2, 3)] + ["2000,3,silent,,"])
        gateway = self.start_gateway(buses, STATE + self.HTTP, **SOON)
        gateway.wait_for_line(r"node 3 is missing")
        self.assertEqual(gateway.stop(), 0)
        stopped = time.monotonic()
        # While it does not run, time goes on.
        wait_for("some seconds", lambda: time.monotonic() - stopped > 6)
        again = self.start("again", [PROGRAMS / "etcm-gateway", "--config", "site.toml"])
        self.url = again.wait_for_line(r"status page on (http://\S+)").group(1)
        since = lambda path, pick: pick(json.loads(self.get(path)))
        alarm = lambda: since("/alarms.json", lambda told: next(
            a["since_ms"] for a in told["alarms"] if a["about"] == {"node": 3}))
        for path, pick in (("/status.json", lambda told: told["missing"][0]["since_ms"]),
                           ("/units.json", lambda told: next(u for u in told["units"] if u["unit"] == 3)["since_ms"])):
            before, there, after = alarm(), since(path, pick), alarm()
            self.assertGreater(before, 8000)
            self.assertTrue(before <= there <= after, (path, before, there, after))
        self.size(1280, 800)
        self.browser.get(self.url)
        self.wait_for_text("#alarm-list", MOMENT)
        self.wait_for_text("#missed", MOMENT)
        self.find("#buses summary").click()
        self.wait_for_text("#buses .units", rf"silent since {MOMENT}")
        self.find("#missed button").click()
        self.wait_for_text("#facts", rf"no answer since {MOMENT}")
        # To the second that ctl says.
        said = re.search(r"node 3,.*\n.*\n\s+since (\S+)", self.ctl("list").stdout).group(1)
        moment = self.browser.execute_async_script("""
            const [said, done] = arguments;
            import('/model.js').then(({ momentText }) => done(momentText(new Date(said))));""", said)
        for part in ("#state", "#alarm-list", "#missed", "#facts", "#buses .units"):
            self.assertIn(f"since {moment}", self.text(part), part)

    def test_the_time_of_an_alarm_is_not_reckoned_by_the_clock_of_the_browser(self):
        self.start_page(["0,1,join,0,0"])
        self.browser.get(self.url)
        self.wait_for_text("#nodes-title", r"\(1\)")
        said = self.browser.execute_async_script("""
            const done = arguments[0];
            import('/model.js').then(({ momentOf, momentText, setBeginnings, sinceText }) => {
              const began = Math.floor(Date.now() / 1000) * 1000 - 60000;
              const since = new Date(began).toISOString();
              // As much as an answer takes.
              const texts = [-900, 100, 1100].map((late) => {
                setBeginnings({ alarms: [{ on: true, kind: 'missing_node', about: { node: 7 }, since }] });
                return sinceText(Date.now() - began + late, 'node 7').split(' (')[0];
              });
              setBeginnings({ alarms: [] });
              const other = sinceText(Date.now() - began + 60000, 'node 7').split(' (')[0];
              done([texts.every((text) => text === momentText(new Date(began))), other === momentText(new Date(began)),
                momentOf({ since, since_ms: 1 }, 'since').getTime() === began,
                Math.abs(momentOf({ since: '', since_ms: 5000 }, 'since') - Date.now() + 5000) < 5000,
                momentOf({ since: '', since_ms: 0 }, 'since')]);
            });""")
        self.assertEqual(said, [True, False, True, True, None])

    def test_a_unit_that_fell_silent_before_a_kill_is_so_since_its_last_answer(self):
        buses = self.start_nodes([f"0,{n},join,{n * 100},{n * n * 20}" for n in (1, 2, 3)] + ["2000,3,silent,,"])
        gateway = self.start_gateway(buses, STATE + self.HTTP, stale_after="1s", leave_after="15s")
        wait_for("all that answer", lambda: self.header()["nodes"] == 3)
        wait_for("a stale node", lambda: self.header()["state"] & 2)
        heard_at = time.monotonic() - 1
        wait_for("a save of that", lambda: time.monotonic() - heard_at > 5)
        gateway.stop(signal.SIGKILL)
        wait_for("some seconds", lambda: time.monotonic() - heard_at > 9)
        again = self.start("again", [PROGRAMS / "etcm-gateway", "--config", "site.toml"])
        self.url = again.wait_for_line(r"status page on (http://\S+)").group(1)
        again.wait_for_line(r"node 3 is missing")
        wait_for("the alarm", lambda: json.loads(self.get("/alarms.json"))["alarms"])
        unit = lambda: next(u for u in json.loads(self.get("/units.json"))["units"] if u["unit"] == 3)["since_ms"]
        before = unit()
        [alarm] = json.loads(self.get("/alarms.json"))["alarms"]
        self.assertLessEqual(before, alarm["since_ms"])
        self.assertLessEqual(alarm["since_ms"], unit())
        self.assertLessEqual(abs(before - 1000 * (time.monotonic() - heard_at)), 3000)

    def found(self, words):
        """The serials that the search of nodes finds."""
        search = self.find("#search")
        search.clear()
        search.send_keys(words)
        return [row.get_attribute("data-serial")
                for row in self.browser.find_elements(By.CSS_SELECTOR, "tr.row")]

    def test_nodes_are_found_by_what_they_say_and_their_details_tell_it(self):
        gateway = self.start_page(["0,1,join,0,0", "0,2,join,1000,0", "0,3,join,400,700", "0,4,join,900,900",
                                   "0,5,join,100,800", "1500,2,low_battery,,", "1500,3,no_fix,,", "4000,5,silent,,"], '[[node]]\nserial = 2\nname = "mill"\n', **SOON)
        self.size(1280, 800)
        self.browser.get(self.url)
        gateway.wait_for_line(r"node 5 is missing")
        for words, serial in (("low battery", "2"), ("no fix", "3"), ("silent", "5"),
                              ("missing", "5"), ("MILL", "2")):
            wait_for(f"node {serial} by '{words}'", lambda: self.found(words) == [serial])
        self.assertEqual(self.found("no fix"), ["3"])
        self.find("tr.row button").click()
        self.wait_for_text("#facts", r"It says\s+no fix, [\d.]+ s ago")
        self.found("battery")
        self.find("#search").send_keys(Keys.ENTER)
        self.wait_for_text("#details-title", r"^Node 2 'mill'$")
        self.wait_for_text("#facts", r"It says\s+it has a fix, low battery, [\d.]+ s ago\s+"
                                     r"Its unit\s+answering for \S+ \S+\s+"
                                     r"Errors\s+\d+ % of the last \d+ questions[^\n]*\s+"
                                     r"Answer in\s+[\d.]+ ms; mean [\d.]+ ms, longest [\d.]+ ms")
        self.screenshot("says")
        self.found("missing")
        self.find("#search").send_keys(Keys.ENTER)
        self.wait_for_text("#facts", rf"(?s)It says\s+it has a fix, \d+.*Its unit\s+silent since {MOMENT}.*timeout")
        # The names of nodes are found among the units too.
        self.find("#buses summary").click()
        self.find("#unit-search").send_keys("mill")
        wait_for("the unit", lambda: [row.split()[0] for row in self.rows()] == ["2"])
        # Nobody looks: nobody asks.
        self.find("#unit-search").clear()
        self.find("#unit-search").send_keys(" ")
        self.find("#search").clear()
        self.find("#search").send_keys(" ")
        self.find("#buses summary").click()
        self.find("#close").click()
        self.wait_for_turns()
        self.forget_what_was_asked()
        self.wait_for_turns(3)
        self.assertEqual(self.asked("/units.json"), 0)

    def test_enter_in_the_search_shows_the_first_hit(self):
        self.start_page(["0,1,join,0,0", "0,2,join,1000,0", "0,3,join,400,700"],
                        '[[bus.device]]\nunits = "9"\n[[node]]\nserial = 2\nname = "mill"\n')
        self.size(1280, 800)
        self.browser.get(self.url)
        self.wait_for_text("#counts", r"Nodes\s*3")
        search = self.find("#unit-search")
        # At once, before any unit has been asked for.
        search.send_keys("mill", Keys.ENTER)
        self.wait_for_text("#details-title", r"^Node 2 'mill'$")
        search.clear()
        search.send_keys("nosuch", Keys.ENTER)
        self.wait_for_text("#no-unit", r"^No match")
        # One without a node has a line alone.
        search.clear()
        search.send_keys("9", Keys.ENTER)
        wait_for("its line", lambda: self.browser.execute_script(
            "return document.activeElement.matches('#buses tbody tr') && "
            "document.activeElement.innerText.startsWith('9')"))
        self.assertEqual(self.text("#details-title"), "Node 2 'mill'")

    def test_the_units_of_a_closed_bus_are_printed(self):
        self.start_page(["0,1,join,0,0", "0,2,join,1000,0", "0,3,join,400,700"])
        self.size(1280, 800)
        self.browser.get(self.url)
        self.wait_for_text("#buses", r"3 of 3 units answer")
        printed = self.browser.execute_script("""
            dispatchEvent(new Event('beforeprint'));
            return [...document.querySelectorAll('#buses details[open] tbody tr')].map((row) => row.innerText)""")
        self.assertEqual([row.split()[0] for row in printed], ["1", "2", "3"])
        self.assertIn("answering", printed[0])
        self.browser.execute_script("dispatchEvent(new Event('afterprint'))")
        self.assertEqual(self.browser.find_elements(By.CSS_SELECTOR, "#buses details[open]"), [])

    def test_with_a_low_battery_not_all_is_well(self):
        self.start_page(["0,1,join,0,0", "0,2,join,1000,0", "0,3,join,400,700", "1500,2,low_battery,,"])
        self.size(1280, 800)
        self.browser.get(self.url)
        self.wait_for_text("#alarm-list", r"low battery|battery is low")
        self.wait_for_text("#state", rf"^Minor: node 2, .*battery.*, since {MOMENT}$")
        # It stays what it is, and is that of the alarm, but for what is left of a second.
        said = self.text("#state")
        self.wait_for_turns(4)
        self.assertEqual(self.text("#state"), said)
        self.assertEqual(self.find("#state").get_attribute("class"), "chip minor")
        self.screenshot("low-battery")

    def test_what_a_node_says_is_of_the_node_that_is_there_now(self):
        self.start_page(["0,1,join,0,0"])
        self.browser.get(self.url)
        said = self.browser.execute_async_script("""
            const done = arguments[0];
            import('/units.js').then(({ conditionsOfNode, setUnits }) => {
              const nodes = [{ serial: 1, bus: 'yard', unit: 7 }, { serial: 2, bus: 'yard', unit: 7, missing: true },
                { serial: 3, bus: 'mill', unit: 7, no_fix: true }, { serial: 4 },
                { serial: 5, bus: 'yard', unit: 99, lowBattery: true }];
              setUnits({ nodes }, [{ bus: 'yard', unit: 7, state: 'answering', serial: 1, moving: true,
                low_battery: true }, { bus: 'mill', unit: 7, state: 'faulty', serial: 3, no_fix: true }]);
              done([...nodes.map(conditionsOfNode), nodes[4].heardBy]);
            });""")
        self.assertEqual(said, [["low battery", "moving"], ["silent"], ["no fix", "faulty"], [],
                                ["low battery"], None])
        # None: it is known that nobody has answered there, so nothing is waited for.


if __name__ == "__main__":
    unittest.main(verbosity=2)
