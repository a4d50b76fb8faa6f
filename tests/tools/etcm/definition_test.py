"""Meshes of many small inputs, by the program as a user runs it, against the definition.

Usage: definition_test.py ETCM [unittest's arguments]. ETCM_INPUTS in the environment is how many inputs;
each is told by its number, so a failure can be repeated."""

import os
import pathlib
import random
import subprocess
import sys
import tempfile
import unittest

import mesh_definition as definition

PROGRAM = sys.argv.pop(1) if len(sys.argv) > 1 else "etcm"
INPUTS = int(os.environ.get("ETCM_INPUTS", "300"))
MOST = 2**24
# Without it a feature that is next to others all along, nearer than the points of its grid, may be
# split for as long as there is memory.
STEINER_MOST = 3000
# The program syncs what it writes, which no disk does some thousand times in a moment.
MEMORY = "/dev/shm" if os.path.isdir("/dev/shm") else None


def even(draw, count):
    side = draw.choice([6, 30, 1000, MOST])
    return [(draw.randint(-side, side), draw.randint(-side, side)) for _ in range(count)]


def on_one_line(draw, count):
    dx, dy = draw.randint(0, 9), draw.randint(0, 9)
    return [(k * dx, k * dy) for k in (draw.randint(-99, 99) for _ in range(count))]


def beside_a_line(draw, count):
    length = draw.choice([50, 10**6, MOST])
    return [(draw.randint(-length, length), draw.choice([0, 0, 1, -1])) for _ in range(count)]


def on_circles(draw, count):
    scale = draw.choice([1, 7, 1000])
    circle = [(x, y) for x in range(-65, 66) for y in range(-65, 66) if x * x + y * y == 65 * 65]
    return [(x * scale, y * scale) for x, y in (draw.choice(circle) for _ in range(count))]


def clusters(draw, count):
    centres = [(draw.randint(-MOST + 9, MOST - 9), draw.randint(-MOST + 9, MOST - 9))
               for _ in range(3)]
    return [(x + draw.randint(-9, 9), y + draw.randint(-9, 9))
            for x, y in (draw.choice(centres) for _ in range(count))]


def fan(draw, count):
    rim = [(draw.randint(900, 1000), k * 20 - 10 * count) for k in range(count)]
    return [(0, 0), *rim]


def two_rows(draw, count):
    step, gap = draw.choice([1, 10, 1000]), draw.choice([1, 2, 50])
    return [(draw.randint(0, count) * step, draw.choice([0, gap])) for _ in range(count)]


FAMILIES = [even, on_one_line, beside_a_line, on_circles, clusters, fan, two_rows]


def draw_features(draw, nodes, most):
    features = []
    for _ in range(4 * most):
        a, b = draw.sample(range(len(nodes)), 2)
        line = (nodes[a], nodes[b])
        if len(features) < most and not any(
                crosses(line, (nodes[c], nodes[d]), nodes) for c, d in features):
            features.append((a, b))
    return features


def crosses(one, other, nodes):
    """Whether two features may not stand together: they may meet where a node is on both."""
    if not definition.meet(*one, *other):
        return False
    if definition.cross(*one, other[0]) == 0 and definition.cross(*one, other[1]) == 0:
        return True
    def is_on(p, line):
        return p in line or definition.is_between(p, *line)
    return not any(is_on(p, one) and is_on(p, other) for p in nodes)


def draw_input(number):
    draw = random.Random(number)
    family = FAMILIES[number % len(FAMILIES)]
    nodes = list(dict.fromkeys(family(draw, draw.randint(3, 40))))
    if len(nodes) < 2:
        nodes += [(12345, 54321), (1, 0)]
    return nodes, draw_features(draw, nodes, draw.randint(0, 1 + len(nodes) // 4))


def longest(nodes, features):
    return max(max(abs(nodes[a][0] - nodes[b][0]), abs(nodes[a][1] - nodes[b][1]))
               for a, b in features)


def write_poly(path, nodes, features):
    lines = [f"{len(nodes)} 2 0 0"]
    lines += [f"{i} {x} {y}" for i, (x, y) in enumerate(nodes, 1)]
    lines += [f"{len(features)} 0"]
    lines += [f"{i} {a + 1} {b + 1}" for i, (a, b) in enumerate(features, 1)]
    path.write_text("\n".join([*lines, "0", ""]))


class Definition(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory(prefix="etcm_test_", dir=MEMORY)
        self.addCleanup(self.folder.cleanup)

    def mesh_of(self, nodes, features, policy="default"):
        folder = pathlib.Path(self.folder.name)
        write_poly(folder / "in.poly", nodes, features)
        run = subprocess.run([PROGRAM, "mesh", folder / "in.poly", "-o", folder / "out", "--domain",
                              "hull", "--policy", policy, "--steiner-max", str(STEINER_MOST)],
                             capture_output=True, text=True)
        if run.returncode == 3:
            return None
        self.assertEqual(run.returncode, 0, run.stderr)
        return (definition.read_places(folder / "out.node"),
                definition.read_triangles(folder / "out.ele"))

    def test_meshes_are_what_they_should_be(self):
        split = refused = 0
        for number in range(INPUTS):
            nodes, features = draw_input(number)
            with self.subTest(number=number, nodes=nodes, features=features):
                policy = "paper" if number % 5 == 0 else "default"
                mesh = self.mesh_of(nodes, features, policy)
                if mesh is None:
                    # What is beside a feature may be nearer than the points of its grid.
                    self.assertGreater(longest(nodes, features), 10**5)
                    refused += 1
                    continue
                places, triangles = mesh
                self.assertEqual(definition.complaints(nodes, features, places, triangles), [])
                split += len(places) > len(nodes)
        self.assertGreater(split, INPUTS // 4, "the inputs are too easy")
        self.assertLess(refused, 1 + INPUTS // 50)
        print(f"{split} with Steiner vertices, {refused} not conforming", file=sys.stderr)


class Spoiled(Definition):
    """What is wrong is seen; else what is said of meshes would mean nothing."""

    test_meshes_are_what_they_should_be = None

    def setUp(self):
        super().setUp()
        self.nodes = [(0, 0), (100, 0), (50, 3), (50, -3), (20, 60), (80, 70), (90, -50)]
        self.features = [(0, 1)]
        self.places, self.triangles = self.mesh_of(self.nodes, self.features)
        self.assertGreater(len(self.places), len(self.nodes))

    def assert_seen(self, words, places=None, triangles=None):
        found = definition.complaints(self.nodes, self.features, places or self.places,
                                      self.triangles if triangles is None else triangles)
        self.assertTrue(any(words in complaint for complaint in found), found)

    def test_whole(self):
        self.assertEqual(definition.complaints(self.nodes, self.features, self.places,
                                               self.triangles), [])

    def test_a_node_moved(self):
        self.assert_seen("a node is missing", [(1, 0), *self.places[1:]])

    def test_a_vertex_off_its_feature(self):
        x, y = self.places[-1]
        self.assert_seen("there is no edge", [*self.places[:-1], (x, y + 1)])
        self.assert_seen("neither a node nor on a feature", [*self.places[:-1], (x, y + 1)])

    def test_a_triangle_missing(self):
        self.assert_seen("the border is not", triangles=self.triangles[1:])

    def test_a_triangle_twice(self):
        self.assert_seen("left of two", triangles=[*self.triangles, self.triangles[0]])

    def test_a_triangle_turned(self):
        turned = [self.triangles[0][::-1], *self.triangles[1:]]
        self.assert_seen("not counter-clockwise", triangles=turned)

    def test_each_edge_flipped(self):
        """An edge between two triangles that make a convex four-sided figure, exchanged for the
        other diagonal: never Delaunay, for no four of these are on one circle."""
        flipped = 0
        for t in self.triangles:
            for u in self.triangles:
                shared = set(t) & set(u)
                if len(shared) != 2 or t > u:
                    continue
                p, = set(t) - shared
                q, = set(u) - shared
                a, b = shared
                new = [n if definition.cross(*(self.places[i] for i in n)) > 0 else n[::-1]
                       for n in ((p, q, a), (q, p, b))]
                if not definition.meet(*(self.places[i] for i in (a, b, p, q))):
                    continue
                rest = [n for n in self.triangles if n not in (t, u)]
                if definition.cross(self.places[p], self.places[q], self.places[a]) == 0 or \
                        definition.cross(self.places[p], self.places[q], self.places[b]) == 0:
                    continue
                self.assert_seen("inside of the circle", triangles=[*rest, *new])
                flipped += 1
        self.assertGreater(flipped, 3)


if __name__ == "__main__":
    unittest.main()
