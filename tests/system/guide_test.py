"""The pictures of the page in the operating guide: each state is brought about, waited for and, by
tools/pictures, drawn anew.

ETCM_BIN is the programs' folder. Every wait is for a condition.
"""
import hashlib
import os
import pathlib
import signal
import struct
import unittest
import zlib

from selenium.webdriver.common.keys import Keys

from browser import BrowserCase
from gateway_test import SOON, wait_for

FIRMWARE = pathlib.Path(__file__).resolve().parents[2] / "firmware"
GUIDE = FIRMWARE / "guide"
DRAWN_OF = pathlib.Path(__file__).parent / "guide_pictures.sha256"
# Those that demo_test.py draws.
OTHERS = {"devices", "fleet"}
PICTURES = {"page", "page-units", "page-wrong", "page-silent", "page-lost", "page-night",
            "page-telephone", "page-plan", "page-paper"}

NODES = 48
ROADS = ((1001, 1020), (1020, 1041), (1007, 1047))
NAMES = {1001: "gate", 1020: "crossing", 1041: "quay", 1007: "pump house"}


def place(number):
    return number * 137 % 1009, number * number * 7 % 641


def png(width, height, colour_of):
    """A picture whose pixel (column, row) has colour_of() it."""
    rows = b"".join(b"\0" + b"".join(bytes(colour_of(column, row)) for column in range(width))
                    for row in range(height))

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)) +
            chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))


def ground(column, row):
    """Meadows, a river from the north to the south, and a yard."""
    bank = 330 + (row - 180) ** 2 // 900
    if abs(column - bank) < 16:
        return 170, 205, 235
    if 90 < column < 210 and 130 < row < 230:
        return 222, 214, 200
    return (222, 236, 212) if (column // 60 + row // 60) % 2 else (228, 240, 219)


class GuidePictures(BrowserCase):
    def start_site(self, more_rows=(), more="", **times):
        rows = [f"0,{1000 + n},join,{x},{y}" for n in range(1, NODES + 1) for x, y in [place(n)]]
        features = "".join(f'[[feature]]\nfrom = {a}\nto = {b}\nname = "road {i}"\n'
                           for i, (a, b) in enumerate(ROADS, 1))
        names = "".join(f'[[node]]\nserial = {serial}\nname = "{name}"\n'
                        for serial, name in NAMES.items())
        gateway = self.start_page([*rows, *more_rows], features + names + more, **times)
        self.size(1280, 800)
        self.browser.get(self.url)
        self.wait_for_text("#counts", rf"Nodes\s*{NODES}")
        return gateway

    def test_every_picture_of_the_page_in_the_guide_is_made_here(self):
        self.assertEqual({path.stem for path in GUIDE.glob("*.png")}, PICTURES | OTHERS)
        text = "".join(path.read_text() for path in GUIDE.glob("*.md"))
        for name in PICTURES | OTHERS:
            self.assertIn(f"({name}.png)", text)
        demo = (pathlib.Path(__file__).parent / "demo_test.py").read_text()
        for name in OTHERS:
            self.assertIn(f'self.guide_picture("{name}"', demo)

    def test_the_pictures_are_those_of_the_page_as_it_is(self):
        if os.environ.get("ETCM_SCREENSHOTS"):
            self.skipTest("they are drawn")
        page = sorted(path for path in (FIRMWARE / "status/page").iterdir()
                      if path.name == "index.html" or path.suffix in (".js", ".css"))
        now = hashlib.sha256(b"".join(path.read_bytes() for path in page)).hexdigest()
        self.assertEqual(DRAWN_OF.read_text().split()[0], now,
                         "the page has changed: draw its pictures anew by tools/pictures, or by "
                         "tools/pictures --same where none of them shows it")

    def test_all_is_well(self):
        (self.folder / "plan.png").write_bytes(png(540, 360, ground))
        (self.folder / "plan.pgw").write_text("2\n0\n0\n-2\n-29\n689\n")
        self.start_site(more='[analysis]\nradio_range = 300\nsensing_range = 120\n'
                             '[site]\nname = "Harbour east"\nplan = "plan.png"\n')
        self.wait_for_text("#state", r"^All well$")
        self.wait_for_text("#legend", r"(?s)Plan.*Coverage holes")
        layer = self.find("#legend label:not(.none) input")
        layer.click()
        self.wait_for_text("#buses", r"48 of 48 units answer")
        self.guide_picture("page")
        self.find("#search").send_keys("pump", Keys.ENTER)
        self.wait_for_text("#details-title", r"^Node 1007 'pump house'$")
        self.wait_for_text("#facts", r"Its unit\s+answering")
        layer.click()
        self.guide_picture("page-plan")
        self.find("#close").click()
        self.find("#search").clear()
        self.wait_for_text("#nodes-title", r"^Nodes \(48\)$")
        self.size(1280, 800, "dark")
        self.guide_picture("page-night")
        self.size(360, 740)
        self.guide_picture("page-telephone")
        self.size(1280, 800)
        self.browser.execute_script("dispatchEvent(new Event('beforeprint'))")
        self.wait_for_text("#printed", r"^Harbour east")
        self.size(700, 990)
        self.guide_picture("page-paper")

    def test_something_is_wrong(self):
        x, y = place(9)
        self.start_site([f"0,{1000 + NODES + 1},join,{x},{y}", "6000,1005,silent,,"], **SOON)
        self.wait_for_text("#alarm-list", r"node 1005\b.* is missing")
        self.wait_for_text("#refused", r"Node 1049.*")
        self.find("#missed button").click()
        self.wait_for_text("#details-title", r"^Node 1005$")
        self.wait_for_text("#facts", r"Its unit\s+silent since")
        self.wait_for_text("#alarms-title", r"^Alarms \(2\)$")
        self.guide_picture("page-wrong")
        self.find("#close").click()
        self.find("#buses summary").click()
        self.wait_for_text("#buses .units", r"(?s)^Unit.*silent since")
        # Painted at once, what scrolls within the panels would be where it was before.
        self.browser.execute_async_script("""
            const [done] = arguments;
            document.querySelector('#bus-list').scrollIntoView();
            requestAnimationFrame(() => requestAnimationFrame(() => requestAnimationFrame(done)));""")
        self.guide_picture("page-units")

    def test_nobody_answers(self):
        gateway = self.start_site(**SOON)
        self.programs[0].process.send_signal(signal.SIGSTOP)
        self.wait_for_text("#buses", r"silent since")
        wait_for("stale nodes", lambda: "Stale" in self.text("#legend") or "48 stale" in self.text("#state"))
        self.guide_picture("page-silent")
        gateway.stop(signal.SIGKILL)
        self.wait_for_text("#lost", r"has not answered since")
        self.guide_picture("page-lost")
        self.programs[0].process.send_signal(signal.SIGCONT)


if __name__ == "__main__":
    unittest.main(verbosity=2)
