"""The status page on paper: the sheets that a real browser prints, read by pdftotext.

ETCM_BIN is the programs' folder. ETCM_SCREENSHOTS, where it is set, is a folder for the sheets.
"""
import base64
import json
import os
import pathlib
import re
import shutil
import signal
import subprocess
import unittest
from xml.etree import ElementTree

from browser import BrowserCase
from gateway_test import SOON, wait_for

NODES = 230
ENDED = 68


class Word:
    def __init__(self, part):
        self.text = part.text
        self.left, self.top, self.right, self.bottom = (
            float(part.get(name)) for name in ("xMin", "yMin", "xMax", "yMax"))

    def overlaps(self, other):
        """By more than lines and letters stand close together. A name on the map has an edge of its own text."""
        return (self.text != other.text and
                min(self.right, other.right) - max(self.left, other.left) > 1 and
                min(self.bottom, other.bottom) - max(self.top, other.top) > (self.bottom - self.top) / 2)


class Paper(BrowserCase):
    def start_crowd(self):
        """Many nodes, some with long names; many alarms that have ended, and some that are on."""
        rows = [f"0,{1000 + n},join,{n * 137 % 1009},{n * n * 7 % 641}" for n in range(1, NODES + 1)]
        rows += [f"2000,{1000 + n},low_battery,," for n in range(1, 7)]
        names = "".join(f'[[node]]\nserial = {1000 + n}\nname = "pump house north {n}"\n' for n in range(1, 40))
        waits = "".join(f"[[feature]]\nfrom = {8000 + n}\nto = {9000 + n}\n" for n in range(ENDED // 2))
        gateway = self.start_page(rows, names + "[[feature]]\nfrom = 1100\nto = 1120\n" + waits, **SOON)
        alarms = lambda: json.loads(self.get("/status.json"))["alarms"]
        wait_for("alarms", lambda: alarms()["on"] >= ENDED + 6)
        config = self.folder / "site.toml"
        config.write_text(config.read_text().replace(waits, ""))
        gateway.process.send_signal(signal.SIGHUP)
        wait_for("alarms that have ended", lambda: alarms()["ended"] >= ENDED)

    def printed(self):
        """The words of each sheet of A4, without what only colours have."""
        data = self.browser.execute_cdp_cmd("Page.printToPDF", {
            "preferCSSPageSize": True, "printBackground": False, "paperWidth": 8.27, "paperHeight": 11.69})
        file = pathlib.Path(os.environ.get("ETCM_SCREENSHOTS", self.folder)) / "paper.pdf"
        file.write_bytes(base64.b64decode(data["data"]))
        read = subprocess.run(["pdftotext", "-bbox", file, "-"], capture_output=True, check=True).stdout
        pages = ElementTree.fromstring(re.sub(rb"^<!DOCTYPE.*\n(.*\n)??(?=<html)", b"", read))
        space = "{http://www.w3.org/1999/xhtml}"
        by_line = lambda word: (round(word.bottom / 3), word.left)
        return [(float(page.get("width")), sorted((Word(part) for part in page.iter(space + "word")), key=by_line))
                for page in pages.iter(space + "page")]

    @unittest.skipUnless(shutil.which("pdftotext"), "needs poppler-utils")
    def test_every_sheet_has_the_head_of_its_table_and_nothing_is_cut_or_printed_over(self):
        self.start_crowd()
        self.size(1280, 800)
        self.browser.get(self.url)
        self.wait_for_text("#ended-title", rf"\({ENDED}\)")
        self.wait_for_text("#nodes-title", rf"\({NODES}\)")
        wide = self.browser.execute_script("""
            dispatchEvent(new Event('beforeprint'));
            return [...document.querySelectorAll('table')].filter((table) =>
              table.scrollWidth > table.parentElement.clientWidth).map((table) => table.outerHTML.slice(0, 200))""")
        self.assertEqual(wide, [], "else all is printed smaller")
        self.browser.execute_script("dispatchEvent(new Event('afterprint'))")
        sheets = self.printed()
        texts = [" ".join(word.text for word in words) for _, words in sheets]
        for at, (width, words) in enumerate(sheets):
            over = [(word.text, other.text) for i, word in enumerate(words) for other in words[:i]
                    if word.overlaps(other)]
            self.assertEqual(over, [], f"sheet {at + 1}")
            self.assertEqual([word.text for word in words if word.right > width - 36], [], f"sheet {at + 1}")
        rows = [at for at, (_, words) in enumerate(sheets) if any(word.text == "fresh" for word in words)]
        self.assertGreater(len(rows), 3)
        for at in rows:
            self.assertRegex(texts[at], r"Serial State Age Unit, bus Position Neighbours", f"sheet {at + 1}")
        units = [at for at, text in enumerate(texts) if "answering for" in text]
        for at in units:
            self.assertRegex(texts[at], r"Unit Node State Errors Answer Notes", f"sheet {at + 1}")
        whole = " ".join(texts)
        first = [word for at in rows for word in sheets[at][1] if word.left < 70]
        self.assertEqual({word.text for word in first if re.match(r"1\d\d\d$", word.text)},
                         {str(1000 + n) for n in range(1, NODES + 1)})
        ended = whole[whole.index("Alarms that have ended"):whole.index("What happened")]
        self.assertEqual(len(re.findall(r"no longer known", ended)), ENDED)
        # A title stands before what it is of.
        for at, (_, words) in enumerate(sheets):
            self.assertNotRegex(" ".join(word.text for word in words[-6:]),
                                r"(Alarms that have ended \(\d+\)|What happened|Buses|Nodes \(\d+\))$", f"sheet {at + 1}")


if __name__ == "__main__":
    unittest.main(verbosity=2)
