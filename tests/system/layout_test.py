"""Whether what the status page shows has room, from a telephone to a wide screen, in a real browser.

ETCM_BIN is the programs' folder. ETCM_SCREENSHOTS, where it is set, is a folder for screenshots.
"""
import unittest

from browser import BrowserCase
from gateway_test import SOON, wait_for

# Texts of neighbouring cells that touch, and what is cut, of the rows that are seen.
CROWDED = """
    const text = (cell) => {
      const boxes = [];
      const walker = document.createTreeWalker(cell, NodeFilter.SHOW_TEXT);
      while (walker.nextNode()) {
        const range = document.createRange();
        range.selectNode(walker.currentNode);
        boxes.push(...range.getClientRects());
      }
      return boxes.filter((box) => box.width > 1 && box.height > 1);
    };
    const wrong = [];
    for (const row of document.querySelectorAll(arguments[0])) {
      const cells = [...row.cells].filter((cell) => cell.offsetWidth > 0);
      cells.forEach((cell, at) => {
        const boxes = text(cell);
        const own = cell.getBoundingClientRect();
        if (boxes.some((box) => box.right > own.right + 1 || box.bottom > own.bottom + 1)) {
          wrong.push(['sticks out', cell.textContent]);
        }
        for (const part of [cell, ...cell.querySelectorAll('*')]) {
          const isCut = getComputedStyle(part).overflow !== 'visible' && (part.scrollWidth > part.clientWidth + 1 ||
            part.scrollHeight > part.clientHeight + 1);
          if (isCut) wrong.push(['is cut', cell.textContent]);
        }
        const next = cells[at + 1] ? text(cells[at + 1]) : [];
        if (boxes.some((box) => next.some((other) => other.left < box.right + 6 && other.right > box.left &&
            other.top < box.bottom && box.top < other.bottom))) wrong.push(['touches the next', cell.textContent]);
      });
    }
    return wrong;"""


class Layout(BrowserCase):
    SIZES = ((360, 740), (480, 800), (640, 400), (768, 1024), (1024, 768), (1280, 800), (1440, 900), (1920, 1080))

    def start_named(self):
        """Names as people give them, and states of each kind."""
        rows = [f"0,{1000 + n},join,{n * 137 % 1009},{n * n * 7 % 641}" for n in range(1, 41)]
        rows += ["1500,1003,low_battery,,", "2500,1004,silent,,", "2500,1005,leave,,", "0,77,join,137,7"]
        names = "".join(f'[[node]]\nserial = {1000 + n}\nname = "pump house north {n}"\n' for n in range(1, 12))
        self.start_page(rows, names, **SOON)

    def named_at_each_width(self):
        """The page with all of them, at one size after the other."""
        self.start_named()
        for width, height in self.SIZES:
            self.size(width, height)
            self.browser.get(self.url)
            self.wait_for_text("#alarms-title", r"^Alarms \(3\)")
            yield width

    def test_the_table_of_nodes_neither_cuts_names_nor_has_columns_run_into_each_other(self):
        for width in self.named_at_each_width():
            self.wait_for_text("#nodes-title", r"\(41\)")
            wait_for("the state of all", lambda: "quarantined" in self.text("#body") and "missing" in self.text("#body"))
            self.assertEqual(self.browser.execute_script(CROWDED, "#columns, #body tr.row"), [], width)
            # A row is as high as the rows that are not made are thought to be.
            thought, *heights = self.browser.execute_script("""
                return [parseFloat(getComputedStyle(document.querySelector('#rows')).getPropertyValue('--row')),
                  ...[...document.querySelectorAll('#body tr.row')].map((row) => row.getBoundingClientRect().height)]""")
            self.assertLessEqual(max(abs(height - thought) for height in heights), 1, (width, heights))
            wide, across = self.browser.execute_script("""
                const area = document.querySelector('#rows');
                return [area.scrollWidth - area.clientWidth, document.documentElement.scrollWidth]""")
            self.assertEqual(wide, 0, width)
            self.assertLessEqual(across, width)
            self.browser.execute_script("document.querySelector('.nodes').scrollIntoView()")
            self.screenshot(f"nodes-{width}")

    def test_on_a_telephone_each_cell_of_a_unit_has_its_heading(self):
        for width in self.named_at_each_width():
            self.browser.execute_script("document.querySelector('#buses summary').click()")
            self.wait_for_text("#buses .units", r"silent since")
            self.assertEqual(self.browser.execute_script(CROWDED, "#buses .units tr"), [], width)
            wide = self.browser.execute_script("""
                const area = document.querySelector('#buses .units');
                return area.scrollWidth - area.clientWidth""")
            self.assertEqual(wide, 0, width)
            self.browser.execute_script("document.querySelector('#bus-list').scrollIntoView()")
            self.screenshot(f"units-{width}")
            labels = self.browser.execute_script("""
                return [...document.querySelector('#buses .units tbody tr').cells].map((cell) =>
                  getComputedStyle(cell, '::before').content)""")
            told = ['"Unit"', '"Node"', '"State"', '"Errors"', '"Answer"', '"Notes"']
            # A screen reader has them from the head of the table; what is drawn is not told again.
            self.assertEqual([label.split(" / ")[0] for label in labels], told if width <= 480 else ["none"] * 6, width)
            roles = self.browser.execute_script("""
                return ['table', 'tr', 'td', 'th'].map((part) =>
                  document.querySelector(`#buses .units ${part}`).getAttribute('role'))""")
            self.assertEqual(roles, ["table", "row", "cell", "columnheader"])


if __name__ == "__main__":
    unittest.main(verbosity=2)
