"""What a conforming Delaunay mesh is, said once more from its definition: whole numbers of any size,
no tolerance, and nothing of the program that made the mesh.

A mesh is read from the .node and .ele files that `etcm mesh --domain hull` writes, its input from the .poly. Places
are counted in 2^-28 of the input's unit, in which all of them are whole."""

from fractions import Fraction

UNIT = 2**28
# Above so many vertices each edge is looked at, and not each vertex against each triangle.
FEW = 80


def cross(a, b, c):
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def in_circle(a, b, c, d):
    """Above 0 where d is inside the circle through a, b, c, which go counter-clockwise."""
    rows = [(p[0] - d[0], p[1] - d[1]) for p in (a, b, c)]
    (ax, ay), (bx, by), (cx, cy) = rows
    aa, bb, cc = (x * x + y * y for x, y in rows)
    return (aa * (bx * cy - cx * by) - bb * (ax * cy - cx * ay) + cc * (ax * by - bx * ay))


def is_between(p, a, b):
    """Whether p is on the straight line from a to b, and neither of them."""
    if p in (a, b) or cross(a, b, p) != 0:
        return False
    return (min(a[0], b[0]) <= p[0] <= max(a[0], b[0])
            and min(a[1], b[1]) <= p[1] <= max(a[1], b[1]))


def meet(a, b, c, d):
    """Whether two lines share a place that is no end of both."""
    if any(is_between(p, a, b) for p in (c, d)) or any(is_between(p, c, d) for p in (a, b)):
        return True
    if {a, b} & {c, d}:
        return {a, b} == {c, d}
    return (cross(a, b, c) * cross(a, b, d) < 0) and (cross(c, d, a) * cross(c, d, b) < 0)


def hull_sides(places):
    """The sides of the convex hull, counter-clockwise, from each place on it to the next; empty where
    all places are on one line."""
    ordered = sorted(places)

    def half(some):
        chain = []
        for p in some:
            while len(chain) > 1 and cross(chain[-2], chain[-1], p) < 0:
                chain.pop()
            chain.append(p)
        return chain

    below, above = half(ordered), half(ordered[::-1])
    if all(cross(ordered[0], ordered[-1], p) == 0 for p in ordered):
        return []
    around = below[:-1] + above[:-1]
    return list(zip(around, around[1:] + around[:1]))


def numbers(path):
    for line in path.read_text().splitlines():
        line = line.split("#")[0]
        if line.strip():
            yield line.split()


def whole(text):
    """A decimal in sub-units; one that is none of theirs is refused."""
    value = Fraction(text) * UNIT
    if value.denominator != 1:
        raise ValueError(f"{text} is not on the grid")
    return value.numerator


def read_places(path):
    rows = list(numbers(path))[1:]
    return [(whole(row[1]), whole(row[2])) for row in rows]


def read_triangles(path):
    return [tuple(int(i) - 1 for i in row[1:4]) for row in list(numbers(path))[1:]]


def covers_hull(places, triangles):
    """Complaints about the triangles as a cover of the convex hull, each place of it once."""
    sides = {}
    area = 0
    for t in triangles:
        doubled = cross(*(places[i] for i in t))
        if doubled <= 0:
            yield f"triangle {t} is not counter-clockwise"
        area += doubled
        for side in ((t[0], t[1]), (t[1], t[2]), (t[2], t[0])):
            if side in sides:
                yield f"side {side} is on the left of two triangles"
            sides[side] = t
    border = {side for side in sides if side[::-1] not in sides}
    hull = hull_sides(places)
    if {(places[a], places[b]) for a, b in border} != set(hull):
        yield "the border is not that of the convex hull"
    # Twice the area of a polygon, from any place.
    if area != sum(cross(places[0], a, b) for a, b in hull):
        yield "the triangles have not the area of the convex hull"
    if {i for t in triangles for i in t} != set(range(len(places))) and hull:
        yield "a vertex is in no triangle"


def is_delaunay(places, triangles):
    """Complaints: no vertex of all may be inside of a triangle's circle."""
    apex = {}
    for t in triangles:
        for k in range(3):
            apex[t[k], t[(k + 1) % 3]] = t[(k + 2) % 3]
    for t in triangles:
        a, b, c = (places[i] for i in t)
        if len(places) <= FEW:
            others = range(len(places))
        else:
            beyond = (apex.get((t[(k + 1) % 3], t[k])) for k in range(3))
            others = [i for i in beyond if i is not None]
        for i in others:
            if i not in t and in_circle(a, b, c, places[i]) > 0:
                yield f"vertex {i} is inside of the circle of {t}"


def conforms(places, triangles, nodes, features):
    """Complaints: each feature is a chain of edges between all the vertices on it, and each vertex
    that is no node is on a feature."""
    edges = {frozenset(pair) for a, b, c in triangles for pair in ((a, b), (b, c), (c, a))}
    if not triangles:
        # On one line each is joined to the next.
        order = sorted(range(len(places)), key=lambda i: places[i])
        edges = {frozenset(pair) for pair in zip(order, order[1:])}
    added = set(range(len(nodes), len(places)))
    for a, b in features:
        on_it = [i for i, p in enumerate(places) if is_between(p, places[a], places[b])]
        added -= set(on_it)
        chain = sorted([a, b, *on_it], key=lambda i: places[i])
        for pair in zip(chain, chain[1:]):
            if frozenset(pair) not in edges:
                yield f"feature {a}, {b}: from {pair[0]} to {pair[1]} there is no edge"
    for i in added:
        yield f"vertex {i} is neither a node nor on a feature"


def complaints(nodes, features, places, triangles):
    """All that is wrong with a mesh of the nodes, in whole units, and the features between them."""
    given = [(x * UNIT, y * UNIT) for x, y in nodes]
    if places[:len(given)] != given:
        return ["a node is missing, or stands elsewhere"]
    if len(set(places)) != len(places):
        return ["two vertices share a place"]
    return [*covers_hull(places, triangles), *is_delaunay(places, triangles),
            *conforms(places, triangles, given, features)]
