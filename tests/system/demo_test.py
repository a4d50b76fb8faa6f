"""tools/demo --live as a newcomer runs it, in the build of the preset release."""
import pathlib
import re
import signal
import unittest
import urllib.request

from programs import PATIENCE_S, ProgramCase

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


if __name__ == "__main__":
    unittest.main(verbosity=2)
