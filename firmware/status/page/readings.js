// What the nodes measure: values by node, between the nodes of a feature, and the steps in which they
// are shown. Knows nothing of the screen.

const bandsWanted = 10;

// Reads readings.json.
export function readReadings(json) {
  const ofQuantity = json.quantities.map(() => new Map());   // serial -> reading
  for (const [serial, quantity, value, ageMs, isStale, expected, disagrees] of json.readings) {
    ofQuantity[quantity].set(serial, { value, ageMs, isStale, expected, disagrees });
  }
  return { instance: json.instance, sequence: json.sequence, quantities: json.quantities, ofQuantity };
}

export function quantityText({ name, unit }) { return unit ? `${name} (${unit})` : name; }

// All that a node measures, as [quantity, reading].
export function readingsOf(readings, serial) {
  if (!readings) return [];
  return readings.quantities.map((quantity, at) => [quantity, readings.ofQuantity[at].get(serial)])
    .filter(([, reading]) => reading);
}

// "1.25 m"
export function valueText(value, unit, digits) {
  if (value === null) return "no value";
  const text = digits === undefined ? String(value) : decimal(value, digits);
  return unit ? `${text} ${unit}` : text;
}

// Values at the points of a mesh, by id, and which nodes of it have one that is stale. What is stale
// or not valid is no value.
export function valuesOn(mesh, ofSerial) {
  const values = new Map();
  for (const node of mesh.nodes) {
    const reading = ofSerial.get(node.serial);
    if (node.id !== undefined && isFresh(reading)) values.set(node.id, reading.value);
  }
  fill(mesh, ofSerial, values);
  const atNodes = new Map(values);
  for (const point of mesh.steiner) {
    const value = betweenNodes(mesh, point, atNodes);
    if (value !== undefined) values.set(point.id, value);
  }
  return values;
}

// Among sensors an anchor, and a node that measures something else, has the mean of those around, the
// near ones first, so that neither makes a hole in the map. Beyond the sensors nobody knows anything. A
// sensor that is stale or says nothing is one that is there: it stays bare.
const fillRounds = 200;

function fill(mesh, ofSerial, values) {
  const hull = hullOf([...values.keys()].map((id) => mesh.points.get(id)));
  const bare = [...mesh.points.values()]
    .filter((point) => point.kind !== "steiner" && !values.has(point.id) && !ofSerial.has(point.serial))
    .filter((point) => isWithin(hull, point))
    .map((point) => [point.id, weightsAround(mesh, point)]);
  for (let round = 0; round < fillRounds; ++round) {
    let greatest = 0;
    for (const [id, around] of bare) {
      const value = meanOf(around, values);
      if (value === undefined) continue;
      const before = values.get(id);
      values.set(id, value);
      greatest = before === undefined ? Infinity : Math.max(greatest, Math.abs(value - before));
    }
    if (!(greatest > 1e-6 * spreadOf(values))) return;
  }
}

// Twice the area of a triangle, above 0 where it goes round counterclockwise.
function turn(a, b, c) { return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x); }

// The corners of the convex hull, counterclockwise.
function hullOf(places) {
  const sorted = [...places].sort((a, b) => a.x - b.x || a.y - b.y);
  const half = (ordered) => {
    const corners = [];
    for (const place of ordered) {
      while (corners.length > 1 && turn(corners.at(-2), corners.at(-1), place) <= 0) corners.pop();
      corners.push(place);
    }
    return corners.slice(0, -1);
  };
  return [...half(sorted), ...half(sorted.reverse())];
}

function isWithin(hull, place) {
  return hull.length > 2 && hull.every((corner, at) => turn(corner, hull[(at + 1) % hull.length], place) >= 0);
}

function meanOf(around, values) {
  let sum = 0;
  let weight = 0;
  for (const [id, near] of around) {
    const value = values.get(id);
    if (value === undefined) continue;
    sum += near * value;
    weight += near;
  }
  return weight > 0 ? sum / weight : undefined;
}

function spreadOf(values) {
  let [least, most] = [Infinity, -Infinity];
  for (const value of values.values()) [least, most] = [Math.min(least, value), Math.max(most, value)];
  return most - least;
}

// The points around it and, through Steiner vertices, behind these: [id, 1 / distance].
function weightsAround(mesh, point) {
  const found = new Map();
  const add = (id) => {
    const at = mesh.points.get(id);
    if (at && at !== point && at.kind !== "steiner") {
      found.set(id, 1 / Math.max(1e-9, Math.hypot(at.x - point.x, at.y - point.y)));
    }
    return at;
  };
  for (const id of point.neighbours) {
    const at = add(id);
    if (at?.kind === "steiner") at.neighbours.forEach(add);
  }
  return [...found];
}

export function isFresh(reading) { return Boolean(reading) && !reading.isStale && reading.value !== null; }

// Of a Steiner vertex: linear between the nodes at the ends of its part of the feature.
function betweenNodes(mesh, point, atNodes) {
  const ends = (point.along ?? []).map((id) => endOf(mesh, point, id));
  if (ends.length !== 2) return undefined;
  const [from, to] = ends.map((end) => end && atNodes.get(end.id));
  if (from === undefined || to === undefined) return undefined;
  const whole = ends[0].length + ends[1].length;
  return whole > 0 ? from + (to - from) * (ends[0].length / whole) : from;
}

// Where one comes from a Steiner vertex by way of one of its neighbours on the feature, and how far
// that is.
export function endOf(mesh, start, next) {
  let length = 0;
  let before = start;
  for (let steps = 0; steps <= mesh.steiner.length; ++steps) {
    const at = mesh.points.get(next);
    if (!at) return null;
    length += Math.hypot(at.x - before.x, at.y - before.y);
    if (at.kind !== "steiner") return { id: at.id, length };
    next = at.along.find((id) => id !== before.id);
    before = at;
  }
  return null;
}

// Round numbers from below the least to above the greatest value: bands lie between them. Where all
// values are one, it is the only bound.
export function boundsOf(values) {
  const sorted = [...values].sort((a, b) => a - b);
  if (sorted.length === 0) return { bounds: [], digits: 0 };
  const [least, most] = [sorted[0], sorted.at(-1)];
  const step = roundStep((most - least) / bandsWanted);
  const first = Math.floor(least / step);
  const last = Math.ceil(most / step);
  // So small a difference that no steps fit between the two numbers.
  if (!(most > least) || !Number.isSafeInteger(last) || !Number.isSafeInteger(first)) {
    return { bounds: [least], digits: undefined };
  }
  const bounds = [];
  for (let at = first; at <= last; ++at) bounds.push(at * step);
  return { bounds, digits: Math.min(9, Math.max(0, -Math.floor(Math.log10(step) + 1e-9))) };
}

// The next of 1, 2 and 5 times a power of ten.
function roundStep(size) {
  const power = 10 ** Math.floor(Math.log10(size));
  return ([1, 2, 5, 10].find((digit) => digit * power >= size * (1 - 1e-9)) ?? 10) * power;
}

// Between which bounds it is, from 0.
export function bandOf(value, bounds) {
  let band = 0;
  while (band + 2 < bounds.length && value >= bounds[band + 1]) ++band;
  return band;
}

// Without a minus before nothing.
export function decimal(value, digits) {
  const text = value.toFixed(digits);
  return Number(text) === 0 ? text.replace("-", "") : text;
}
