"""What the page says of alarms, in a real browser: those that are on, and those that have ended.

ETCM_BIN is the programs' folder. ETCM_SCREENSHOTS, where it is set, is a folder for screenshots.
Every wait is for a condition.
"""
import re
import signal
import socket
import unittest

from selenium.common.exceptions import StaleElementReferenceException
from selenium.webdriver.common.keys import Keys

from browser import BrowserCase
from gateway_test import SOON, wait_for
from page_test import MOMENT


class Alarms(BrowserCase):
    def test_alarms_that_have_ended_are_listed_when_somebody_looks(self):
        gateway = self.start_page(["0,1,join,0,0", "0,2,join,1000,0", "0,3,join,400,700",
                                   "10000,2,silent,,", "13000,3,silent,,"], **SOON)
        self.size(1280, 800)
        self.browser.get(self.url)
        self.forget_what_was_asked()
        for node in "2", "3":
            gateway.wait_for_line(rf"node {node} is missing")
        self.wait_for_text("#alarms-title", r"^Alarms \(2\)")
        self.wait_for_text("#state", rf"^Major: node \d, unit \d of \S+, is missing, since {MOMENT}\nand 1 more alarm")
        self.assertFalse(self.find("#ended").is_displayed(), "none has ended")
        self.ctl("acknowledge", "all")
        self.ctl("dismiss", "2")
        self.wait_for_text("#ended-title", r"^Alarms that have ended \(1\)$")
        self.ctl("dismiss", "3")
        self.wait_for_text("#ended-title", r"^Alarms that have ended \(2\)$")
        self.wait_for_text("#state", r"^All well$")
        self.wait_for_turns()
        self.assertEqual(self.asked("/ended.json"), 0, "nobody looks")
        # On paper it is open and whole at once; nobody could open it there.
        printed = self.browser.execute_script("""
            dispatchEvent(new Event('beforeprint'));
            return document.querySelectorAll('#ended details[open] #ended-list li').length""")
        self.assertEqual(printed, 2)
        self.browser.execute_script("dispatchEvent(new Event('afterprint'))")
        self.assertFalse(self.find("#ended-list").is_displayed(), "folded again")
        self.forget_what_was_asked()

        # By the keyboard.
        self.find("#ended summary").send_keys(Keys.ENTER)
        self.wait_for_text("#ended-list", rf"(?s)^major\s*node 3, unit 3 of \S+, is missing\s*since {MOMENT}\s*"
                                          rf"until {MOMENT}\s*for [\d.]+ s\s*dismissed\s*acknowledged\s*major\s*node 2, ")
        self.assertEqual(self.text("#ended-bound"), "", "all are shown")
        self.wait_for_turns()
        self.assertEqual(self.asked("/ended.json"), 0, "nothing is new")
        self.browser.execute_script("dispatchEvent(new Event('beforeprint'))")
        self.browser.execute_script("dispatchEvent(new Event('afterprint'))")
        self.assertTrue(self.find("#ended-list").is_displayed(), "what was open stays so")
        self.find("#ended").location_once_scrolled_into_view
        self.screenshot("ended")
        # A screen reader is told what the list is of, and gets to its rows.
        listed = self.find("#ended-list")
        self.assertEqual(self.find("#" + listed.get_attribute("aria-labelledby")).text,
                         "Alarms that have ended (2)")
        self.assertEqual(listed.aria_role, "list")
        self.assertEqual(listed.get_attribute("tabindex"), "0")
        self.find('#ended a[href="alarms.csv"]')
        self.assertEqual(re.findall(r"is missing", self.get("/alarms.csv").decode()), ["is missing"] * 2)
        self.assertEqual([entry for entry in self.browser.get_log("browser")
                          if entry["level"] == "SEVERE"], [])

    def test_each_severity_has_a_sign_and_a_colour_of_its_own_on_paper_too(self):
        self.start_page(["0,1,join,0,0", "0,2,join,1000,0"])
        self.size(1280, 800)
        self.browser.get(self.url)
        self.wait_for_text("#state", r"^All well$")
        seen = self.browser.execute_async_script("""
            const done = arguments[0];
            import('/alarms.js').then(({ showAlarms }) => {
              const alarms = ['critical', 'major', 'minor'].map((severity, at) => ({ number: at + 1, times: 1, severity,
                on: true, acknowledged: false, since: '2026-11-23T15:08:24Z', since_ms: 1000, text: `alarm ${at}`, cure: '' }));
              showAlarms({ instance: 'x', alarms: { edition: 1 } }, { alarms, untold: 0 });
              const looks = () => [...document.querySelectorAll('#alarm-list .severity')].map((part) =>
                [getComputedStyle(part, '::before').content.slice(0, 3), getComputedStyle(part).color]);
              const shown = looks();
              dispatchEvent(new Event('beforeprint'));
              done([shown, looks(), getComputedStyle(document.querySelector('.mark') ?? document.body, '::before')
                .printColorAdjust]);
            });""")
        for looks in seen[:2]:
            for at in 0, 1:
                self.assertEqual(len({look[at] for look in looks}), 3, looks)
        self.browser.execute_script("dispatchEvent(new Event('afterprint'))")
        self.assertEqual(seen[2], "exact", "a printer leaves out what is background")

    def test_a_problem_of_the_drawing_that_is_cured_is_told_as_cured(self):
        gateway = self.start_page(["0,1,join,0,0", "0,2,join,1000,0", "0,3,join,1000,1000", "0,4,join,0,1000"],
                                  "[[feature]]\nfrom = 1\nto = 3\n[[feature]]\nfrom = 2\nto = 4\n")
        self.browser.get(self.url)
        self.alarm(r"^feature 2 ")
        config = self.folder / "site.toml"
        config.write_text(config.read_text().replace("from = 2\nto = 4", "from = 1\nto = 4"))
        gateway.process.send_signal(signal.SIGHUP)
        self.wait_for_text("#ended-title", r"^Alarms that have ended \(1\)$")
        self.find("#ended summary").send_keys(Keys.ENTER)
        self.wait_for_text("#ended-list", r"cured")
        self.assertNotIn("no longer known", self.text("#ended-list"))
        self.assertRegex(self.ctl("list", "--all").stdout, r"until \S+, cured\n")

    def said(self, *alarms, untold=0, **more):
        """The banner where those alarms are on: severity, text and, in minutes, for how long."""
        on = [{"on": True, "severity": severity, "text": text, "cure": f"mend {text}; how: /guide/ctl.html#alarms",
               "since": f"2026-11-23T15:{60 - minutes:02}:00Z", "since_ms": minutes * 60000}
              for severity, text, minutes in alarms]
        return self.browser.execute_async_script("""
            const [alarms, untold, more, done] = arguments;
            import('/banner.js').then(({ stateInWords }) => done(stateInWords({
              state: {}, nodes: 2, waiting_nodes: 0, quarantined: 0, stale_nodes: 0, features_configured: 0,
              features_active: 0, disagreeing_sensors: 0, troubles: [], ...more }, { alarms, untold })));""",
            on, untold, more)

    def test_while_an_alarm_is_on_not_all_is_well(self):
        self.start_page(["0,1,join,0,0", "0,2,join,1000,0"])
        self.browser.get(self.url)
        self.wait_for_text("#state", r"^All well$")
        self.assertEqual(self.said(), ["good", "All well"])
        self.assertEqual(self.said(stale_nodes=3), ["note", "3 stale"])
        self.assertEqual(self.said(nodes=0), ["note", "No node in the mesh"])
        # Before it is an alarm.
        self.assertEqual(self.said(troubles=["node 5 is missing; how: /guide/nodes.html"]), ["major", "node 5 is missing"])

    def test_the_banner_is_of_the_worst_alarm_and_of_these_the_longest(self):
        self.start_page(["0,1,join,0,0", "0,2,join,1000,0"])
        self.browser.get(self.url)
        self.wait_for_text("#state", r"^All well$")
        colour, words = self.said(("minor", "a", 9))
        self.assertEqual(colour, "minor")
        self.assertRegex(words, rf"^Minor: a, since 23 Nov 2026, \d\d:51:00 \S+$")
        # Who is only stale has no part in its time, and a lesser alarm neither.
        colour, words = self.said(("minor", "a", 9), ("major", "b", 3), ("major", "c", 5), stale_nodes=3)
        self.assertEqual(colour, "major")
        self.assertRegex(words, r"^Major: c, since 23 Nov 2026, \d\d:55:00 \S+\nand 2 more alarms, 3 stale$")
        colour, words = self.said(("major", "b", 3), ("critical", "d", 1), untold=4, troubles=["b"], nodes=0)
        self.assertEqual(colour, "critical")
        self.assertRegex(words, r"^Critical: d, since .*:59:00 \S+\nand 5 more alarms, no node in the mesh$")
        looks = self.browser.execute_script("""
            const chip = document.querySelector('#state');
            return ['critical', 'major', 'minor', 'note', 'good'].map((name) => {
              chip.className = `chip ${name}`;
              return [getComputedStyle(chip, '::before').content, getComputedStyle(chip).color,
                getComputedStyle(chip).backgroundColor];
            });""")
        for at in range(3):
            self.assertEqual(len({look[at] for look in looks}), 5, looks)

    def focused(self):
        return self.browser.execute_script("return document.activeElement.innerText")

    def alarm(self, pattern):
        def found():
            try:
                return next((button for button in self.browser.find_elements("css selector", "#alarm-list button")
                             if re.search(pattern, button.text)), None)
            except StaleElementReferenceException:
                return None  # the list was drawn anew meanwhile
        return wait_for(f"an alarm '{pattern}'", found)

    def test_an_alarm_leads_to_what_it_is_about(self):
        # A node that falls silent, features that cross, a bus without anybody.
        nobody = socket.create_server(("127.0.0.1", 0))
        self.addCleanup(nobody.close)
        gateway = self.start_page_with_room(
            ["0,1,join,0,0", "0,2,join,1000,0", "0,3,join,1000,1000", "0,4,join,0,1000",
             "0,5,join,700,300", "4000,5,silent,,"],
            "[[feature]]\nfrom = 1\nto = 3\n[[feature]]\nfrom = 2\nto = 4\n", **SOON)
        self.size(1280, 800)
        self.browser.get(self.url)
        gateway.wait_for_line(r"node 5 is missing")

        self.alarm(r"^node 5, unit 5 of").send_keys(Keys.ENTER)
        self.wait_for_text("#details-title", r"^Node 5$")
        self.assertEqual(self.focused(), "Node 5")
        self.find("#details-title").send_keys(Keys.ESCAPE)
        wait_for("closed details", lambda: not self.find("#details").is_displayed())
        self.assertRegex(self.focused(), r"^node 5, unit 5 of", "back where one was")

        self.alarm(r"^feature 2 ").click()
        self.wait_for_text("#details-title", r"^Feature 2 refused$")
        self.wait_for_text("#facts", r"In its way\s+feature 1\b")
        self.wait_for_text("#refused", r"it crosses feature 1\b")

        self.alarm(r"^bus \S+ is silent").send_keys(Keys.ENTER)
        wait_for("an open bus", lambda: self.find("#buses li:nth-child(2) details[open]"))
        self.assertTrue(self.focused().startswith(self.second), self.focused())
        self.screenshot("leads")

    def test_an_alarm_leads_to_a_unit_and_to_a_gateway(self):
        self.start_page(["0,1,join,0,0", "0,2,join,1000,0"], '[[bus.device]]\nunits = "9"\n'
                        '[mqtt]\nbroker = "127.0.0.1:9"\nsite = "yard"\nname = "north"\n', **SOON)
        self.size(1280, 800)
        self.browser.get(self.url)
        self.forget_what_was_asked()
        self.wait_for_text("#members", r"^north \(this one\)")
        unit = self.alarm(r"^unit 9 of \S+ has not answered since the start")
        unit.send_keys(Keys.ENTER)
        wait_for("the row of the unit", lambda: re.search(r"^9\s", self.focused()))
        self.assertEqual(self.browser.execute_script("return document.activeElement.tagName"), "TR")
        self.browser.execute_script("""
            import('/leads.js').then(({ Leads }) => new Leads({}).follow({ gateway: 'north' }));""")
        wait_for("the gateway", lambda: self.focused().startswith("north (this one)"))
        # It keeps the focus while its figures change.
        self.wait_for_turns()
        self.assertTrue(self.focused().startswith("north (this one)"))

    def test_on_a_telephone_alarms_stand_before_the_map(self):
        self.start_page(["0,1,join,0,0", "0,2,join,1000,0", "0,3,join,400,700", "3000,2,silent,,"], **SOON)
        for width, height in ((360, 740), (640, 400)):
            self.size(width, height)
            self.browser.get(self.url)
            self.wait_for_text("#alarms-title", r"^Alarms \(1\)$")
            top = lambda part: self.find(part).rect["y"]
            wait_for("alarms above the map", lambda: top("#alarms") < top("#map"))
            self.assertLessEqual(self.browser.execute_script("return document.documentElement.scrollWidth"), width)
            self.screenshot(f"alarms-{width}")
            self.alarm(r"^node 2").click()
            self.wait_for_text("#details-title", r"^Node 2$")
            self.wait_for_text("#facts", r"Its unit\s+silent since")
            self.assertTrue(self.browser.execute_script("""
                const box = document.querySelector('#details-title').getBoundingClientRect();
                return box.top >= 0 && box.bottom <= innerHeight"""), "it is seen")
            self.screenshot(f"alarm-details-{width}")
        self.size(1280, 800)
        wait_for("alarms beside the map", lambda: self.find("#alarms").rect["x"] > self.find("#map").rect["x"])

    def test_an_alarm_leads_to_the_line_of_a_node_that_nobody_has_heard(self):
        self.start_page(["0,1,join,0,0", "0,2,join,1000,0"], "[[feature]]\nfrom = 1\nto = 77\n", **SOON)
        self.size(1280, 800)
        self.browser.get(self.url)
        self.alarm(r"^node 77").send_keys(Keys.ENTER)
        wait_for("the line of node 77", lambda: self.browser.execute_script(
            "return document.activeElement.closest('#never') && document.activeElement.innerText"))
        self.assertIn("77", self.focused())

    def test_all_alarms_are_printed(self):
        self.start_page(["0,1,join,0,0", "0,2,join,1000,0"])
        self.browser.get(self.url)
        self.wait_for_text("#state", r"^All well$")
        shown, printed, after = self.browser.execute_async_script("""
            const done = arguments[0];
            import('/alarms.js').then(({ showAlarms }) => {
              const alarms = Array.from({ length: 150 }, (_, at) => ({ number: at + 1, times: 1, severity: 'major',
                on: true, acknowledged: false, since: '2026-11-23T15:08:24Z', since_ms: 1000, text: `alarm ${at}`, cure: '' }));
              showAlarms({ instance: 'x', alarms: { edition: 1 } }, { alarms, untold: 0 });
              const more = document.querySelector('#alarms-more');
              const seen = () => [document.querySelectorAll('#alarm-list li').length, more.hidden ? '' : more.textContent];
              const shown = seen();
              dispatchEvent(new Event('beforeprint'));
              const printed = seen();
              dispatchEvent(new Event('afterprint'));
              done([shown, printed, seen()]);
            });""")
        self.assertEqual(shown, [100, "and 50 more: sudo etcm-gateway ctl list"])
        self.assertEqual(printed, [150, ""])
        self.assertEqual(after, shown)

    def test_how_many_of_the_ended_alarms_are_shown_is_told(self):
        self.start_page(["0,1,join,0,0", "0,2,join,1000,0"])
        self.browser.get(self.url)
        self.wait_for_text("#state", r"^All well$")
        shown = self.browser.execute_async_script("""
            const done = arguments[0];
            import('/ended.js').then(({ countEnded, showEnded }) => {
              const ago = (ms) => new Date(Date.now() - ms).toISOString();
              const alarm = (number, until_ms) => ({ number, times: 1, severity: 'major', on: false,
                acknowledged: false, since: ago(until_ms + 60000), since_ms: until_ms + 60000, until: ago(until_ms), until_ms,
                text: `alarm ${number}`, cure: '' });
              const ended = Array.from({ length: 100 }, (_, at) => alarm(2000 - at, 2e6 + at * 1000));
              const lately = [alarm(2001, 9000), alarm(2003, 5000),
                { ...alarm(2002, 0), until: '', since: '', since_ms: 0 }];
              const status = { instance: 'x', alarms: { edition: 1, ended: 2431 } };
              countEnded(status);
              showEnded(status, { alarms: lately, ended });
              const rows = [...document.querySelectorAll('#ended-list li')].map((row) => row.textContent);
              done([document.querySelector('#ended-title').textContent,
                document.querySelector('#ended-bound').textContent, rows]);
            });""")
        self.assertEqual(shown[0], "Alarms that have ended (2431)")
        self.assertEqual(shown[1], "The last 100 of 2431.")
        self.assertEqual(len(shown[2]), 100)
        self.assertRegex(shown[2][0], r"^majoralarm 2002since a time that is not knownuntil a time that is not known$")
        self.assertRegex(shown[2][1], rf"^majoralarm 2003since {MOMENT}until {MOMENT}for 60 s$")
        self.assertRegex(shown[2][3], r"^majoralarm 2000since")


if __name__ == "__main__":
    unittest.main(verbosity=2)
