#!/usr/bin/env python3
"""Each kind of change is planted where it belongs, and nowhere else; what survivors.txt explains is there."""

import unittest
from pathlib import Path

from changes import changes_of
from groups import GROUPS
from survivors import Explained

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]


def planted(text):
    return sorted(change.after.strip() for change in changes_of("a.cpp", text))


class Changes(unittest.TestCase):
    def test_operators(self):
        self.assertEqual(planted("x = a < b;\n"), ["x = a <= b;"])
        self.assertEqual(planted("x = a &&\n"), ["x = a ||"])
        self.assertEqual(planted("x = a - b;\n"), ["x = a + b;"])
        self.assertEqual(planted("  return !a && -b;\n"),
                         ["return !a && b;", "return !a || -b;", "return a && -b;"])

    def test_brackets_of_templates_arrows_and_references_are_no_operators(self):
        self.assertEqual(planted("std::span<const Edge> f(Edge&& e, int* p) { return p->x; }\n"), [])

    def test_numbers_and_truths(self):
        self.assertEqual(planted("x = f(7, 0x0f, 1.5, 2u, a1);\n"),
                         ["x = f(7, 0x0f, 1.5, 3u, a1);", "x = f(7, 0x0f, 2.5, 2u, a1);",
                          "x = f(7, 0x10, 1.5, 2u, a1);", "x = f(8, 0x0f, 1.5, 2u, a1);"])
        self.assertEqual(planted("x = true;\n"), ["x = false;"])

    def test_conditions_over_two_lines_and_behind_a_declaration(self):
        self.assertEqual(planted("  if (f(a) ||\n      b) return;\n"),
                         ["if (!(f(a) ||", "if (f(a) &&"])
        self.assertEqual(planted("  if (const auto a = f(); a) return;\n"),
                         ["if (const auto a = f(); !(a)) return;"])
        over_two = changes_of("a.cpp", "if (f(a) ||\n    b) x();\n")[0]
        self.assertEqual(over_two.applied("if (f(a) ||\n    b) x();\n"), "if (!(f(a) ||\n    b)) x();\n")

    def test_statements_are_taken_out_and_declarations_are_not(self):
        self.assertEqual(planted("  owed.forget(question);\n"), [";"])
        self.assertEqual(planted("  m.owner(v) = owner;\n"), [";"])
        self.assertEqual(planted("  Edge e = first;\n  return e;\n  void f(Edge e);\n"), [])

    def test_what_is_said_and_what_stops_a_program_stays(self):
        self.assertEqual(planted('// a < b\nf("a < b", c);\n  ETCM_CHECK(a < b);\n#if A > 1\n'), [])


class Survivors(unittest.TestCase):
    def test_each_group_has_its_sources(self):
        for group in GROUPS.values():
            for file in group.files:
                self.assertTrue(changes_of(file, (ROOT / file).read_text()) or file.endswith(".h"), file)

    def test_what_is_explained_is_a_change_of_a_line_that_is_there(self):
        changes = {(change.file, change.before.strip(), change.after.strip())
                   for group in GROUPS.values() for file in group.files
                   for change in changes_of(file, (ROOT / file).read_text())}
        self.assertLessEqual(Explained(HERE / "survivors.txt").reasons.keys(), changes)


if __name__ == "__main__":
    unittest.main()
