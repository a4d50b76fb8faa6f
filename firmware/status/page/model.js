// What the gateway said, as the rest of the page wants it. Knows nothing of the screen.

// The states of a node, best first; "waiting" has told no place yet, "left" has said that it leaves,
// "missing" fell silent and left the mesh for that.
export const nodeStates = ["fresh", "ageing", "stale", "quarantined", "waiting", "left", "missing"];

// Reads mesh.json.
export function readMesh(geojson) {
  const mesh = {
    generation: geojson.generation,
    instance: geojson.instance,
    points: new Map(),    // by id
    bySerial: new Map(),
    byPlace: new Map(),   // points by "x,y"
    items: {},            // by kind (items.js)
    nodes: [],
    steiner: [],
    edges: [],            // pairs of places
    features: [],
    longLinks: [],
    gaps: [],             // segments of features that no node senses
    relays: [],           // beside the Steiner vertices
    holes: [],            // places out of the sensing range
    radioRange: geojson.radio_range,
    sensingRange: geojson.sensing_range,
    metresPerUnit: geojson.metres_per_unit,   // undefined where nobody has said
    inactive: [],         // features that are not in the mesh
    bounds: null,
  };
  for (const feature of geojson.features) {
    const { kind } = feature.properties;
    if (kind === "node" || kind === "steiner" || kind === "anchor") addPoint(mesh, feature);
    else if (kind === "edges") mesh.edges = feature.geometry.coordinates;
    else if (kind === "features") mesh.features = feature.geometry.coordinates;
    else if (kind === "gaps") mesh.gaps = feature.geometry.coordinates;
    else if (kind === "relay") mesh.relays.push(placeOf(feature));
    else if (kind === "hole") mesh.holes.push(placeOf(feature));
    else if (kind === "long_links") mesh.longLinks = feature.geometry.coordinates;
    else if (kind === "missing") mesh.inactive.push(feature.properties);
  }
  return mesh;
}

function placeOf(feature) {
  const [x, y] = feature.geometry.coordinates;
  return { x, y, ...feature.properties };
}

function addPoint(mesh, feature) {
  const { properties } = feature;
  const place = feature.geometry?.coordinates;
  const point = {
    ...properties,
    id: feature.id,
    isNode: properties.kind === "node",
    x: place?.[0],
    y: place?.[1],
    hasPlace: place !== undefined,
    neighbours: properties.neighbours ?? [],
    ageMs: undefined,
    state: "fresh",
  };
  if (point.id !== undefined) mesh.points.set(point.id, point);
  if (point.isNode) {
    mesh.nodes.push(point);
    mesh.bySerial.set(point.serial, point);
  } else if (properties.kind === "steiner") {
    mesh.steiner.push(point);
  }
  if (point.hasPlace) {
    if (point.id !== undefined) mesh.byPlace.set(`${point.x},${point.y}`, point);
    // What stands far from all others, by a mistake most often, would make a dot of the rest.
    if (properties.far) return;
    const b = (mesh.bounds ??= { left: point.x, right: point.x, bottom: point.y, top: point.y });
    b.left = Math.min(b.left, point.x);
    b.right = Math.max(b.right, point.x);
    b.bottom = Math.min(b.bottom, point.y);
    b.top = Math.max(b.top, point.y);
  }
}

// Takes over ages.json, [[serial, milliseconds], ...], missing nodes, and what follows from them.
export function setAges(mesh, ages, status) {
  for (const [serial, ageMs] of ages) {
    const node = mesh.bySerial.get(serial);
    if (node) node.ageMs = ageMs;
  }
  for (const missing of status.missing) {
    const node = mesh.bySerial.get(missing.serial);
    if (node) node.missingMs = missing.since_ms;
  }
  for (const left of status.left) {
    const node = mesh.bySerial.get(left.serial);
    if (node) node.leftMs = left.since_ms;
  }
  for (const node of mesh.nodes) node.state = stateOf(node, status.stale_after_ms);
}

// A state in words.
export function wordOfState(state) { return state === "left" ? "has left" : state; }

// "said so at 23 Nov 2026, 14:03:10 CET", of a node that has left.
export function leftText(node) {
  return node.leftMs === undefined ? "" : `said so at ${momentText(dateOf(node.leftMs))}`;
}

// Takes over from alarms.json which nodes say that their battery is low.
export function setBatteries(mesh, { alarms }) {
  const low = new Set(alarms.filter((alarm) => alarm.on && alarm.kind === "low_battery")
    .map((alarm) => alarm.about?.node));
  for (const node of mesh.nodes) node.lowBattery = low.has(node.serial);
}

function stateOf(node, staleAfterMs) {
  if (node.missing) return "missing";
  if (node.left) return "left";
  if (node.refused) return "quarantined";
  if (!node.in_mesh) return "waiting";
  // The gateway that hears a node knows best, and tells others seldom that nothing is new.
  if (node.owner !== undefined) return node.stale ? "stale" : "fresh";
  if (node.stale || node.ageMs > staleAfterMs) return "stale";
  return node.ageMs > staleAfterMs / 2 ? "ageing" : "fresh";
}

// "1.2 s", "4 min", "3 h": as fine as a person wants it.
export function ageText(ageMs) {
  if (ageMs === undefined) return "–";
  const seconds = Math.max(0, ageMs) / 1000;
  if (seconds < 10) return `${seconds.toFixed(1)} s`;
  if (seconds < 120) return `${Math.round(seconds)} s`;
  if (seconds < 7200) return `${Math.round(seconds / 60)} min`;
  return `${Math.round(seconds / 3600)} h`;
}

// Of the page's language, and of the zone of who looks.
const moment = new Intl.DateTimeFormat("en-GB", { day: "numeric", month: "short", year: "numeric",
  hour: "2-digit", minute: "2-digit", second: "2-digit", hour12: false, timeZoneName: "short" });

// "23 Nov 2026, 14:03:10 CET"
export function momentText(date) { return moment.format(date); }

const shortMoment = new Intl.DateTimeFormat("en-GB", { day: "numeric", month: "short", hour: "2-digit",
  minute: "2-digit", hour12: false });

// "23 Nov, 14:03", where there is little room.
export function shortMomentText(date) { return shortMoment.format(date); }

// By how much the clock of the gateway is before that of the browser, which may be wrong.
let clockAheadMs = 0;

// Takes over the time of day that the gateway has told just now.
export function setClock({ time_ms }) {
  // Without one that is set, the browser's.
  clockAheadMs = time_ms > 0 ? time_ms - Date.now() : 0;
}

export function dateOf(ageMs) { return new Date(Date.now() + clockAheadMs - ageMs); }

// When that was, as `since` or another time by `name`: the instant that the gateway tells, which is the
// same wherever it is told. Where the time of day is not known there, by how long ago it was; null: that
// is not known either.
export function momentOf(told, name) {
  if (told[name]) return new Date(told[name]);
  const ageMs = told[`${name}_ms`];
  return ageMs > 0 || told[name] === undefined ? dateOf(ageMs) : null;
}

// When alarms began, by what they are about: "node 7", "bus yard".
let beginnings = new Map();
const sameMs = 2000;   // an alarm tells whole seconds, and an answer takes a while

// Takes over from alarms.json since when nodes are missing and buses silent.
export function setBeginnings({ alarms }) {
  beginnings = new Map();
  for (const { on, kind, about, since } of alarms) {
    if (!on || !about || !since) continue;
    if (kind === "missing_node") beginnings.set(`node ${about.node}`, new Date(since));
    if (kind === "silent_bus") beginnings.set(`bus ${about.bus}`, new Date(since));
  }
}

// "23 Nov 2026, 14:03:10 CET (4 min)"; where an alarm about `subject` is on since then, as it has it, to
// the second.
export function sinceText(ageMs, subject) {
  const date = dateOf(ageMs);
  const told = beginnings.get(subject);
  const began = told && Math.abs(told - date) < sameMs ? told : date;
  return `${momentText(began)} (${ageText(ageMs)})`;
}

export function placeText(point) {
  return point.hasPlace ? `${coordinate(point.x)}, ${coordinate(point.y)}` : "–";
}

// "63.430500° N, 10.395100° E", or nothing where the site has no degrees.
export function degreesText(point) {
  if (point.latitude === undefined) return "";
  const angle = (value, positive, negative) =>
    `${Math.abs(value).toFixed(6)}° ${value < 0 ? negative : positive}`;
  return `${angle(point.latitude, "N", "S")}, ${angle(point.longitude, "E", "W")}`;
}

// An end of a feature is the serial of a node or the place of an anchor.
export function placeOfEnd(mesh, end) {
  if (Array.isArray(end)) return end;
  const node = mesh.bySerial.get(end);
  return node?.hasPlace ? [node.x, node.y] : null;
}

// A length in units: "250 units", or "2.5 km" where it is known how long they are.
export function lengthText(units, metresPerUnit) {
  const round = (value) => Number(value.toPrecision(3));
  if (!metresPerUnit) return `${round(units)} units`;
  const metres = units * metresPerUnit;
  if (metres >= 1000) return `${round(metres / 1000)} km`;
  return metres >= 1 ? `${round(metres)} m` : `${round(metres * 1000)} mm`;
}

function coordinate(value) {
  return Number.isInteger(value) ? String(value) : value.toFixed(2);
}

// Where a node is heard, as two texts: its unit and its bus. One whose unit another node has now is
// somewhere else, if anywhere.
export function whereParts(node) {
  if (node.owner !== undefined) return [`at ${node.owner}`, ""];
  return node.bus === undefined ? ["–", ""] : [String(node.unit), node.bus];
}

export function whereText(node) { return whereParts(node).filter(Boolean).join(", "); }

// "7", or "7 'pump house'": a node, a feature or what is told of one, by its number and its name.
export function calledText(number, name) { return name ? `${number} '${name}'` : String(number); }

export function featureText(point) { return calledText(point.feature, point.feature_name); }

// Of a feature that is refused for it, another; "" where none is in its way.
export function blockerText(feature) {
  if (feature.blocker === undefined) return "";
  const place = feature.near ? `, near (${feature.near.join(", ")})` : "";
  return `feature ${calledText(feature.blocker, feature.blocker_name)}${place}`;
}

export function nameOf(point) {
  if (point.isNode) return `Node ${calledText(point.serial, point.name)}`;
  return point.kind === "anchor" ? `Anchor (${point.x}, ${point.y})` : `Proposed relay ${point.id}`;
}
