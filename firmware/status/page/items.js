// What the map shows beside points: lines, coverage holes, barrier gaps, links, proposed relays. An item
// has a place of its own (`x`, `y`), so that the map can go there. Knows nothing of the screen.
import { featureAlong, featureName, featureOf, lineOf, meetingText } from "./features.js";
import { blockerText, featureText, lengthText, nameOf, placeOfEnd, placeText } from "./model.js";

// By the layer of the legend that shows it; the first is the one that is found where several are.
const titles = {
  relay: "Proposed relay", gap: "Barrier gap", link: "Link too long", refused: "Feature refused",
  feature: "Feature edge", edge: "Edge", hole: "Coverage hole",
};
const whole = "whole";   // a feature from end to end; not found on the map, but by its name
export const layerOfItem = {
  relay: "steiner", gap: "gaps", link: "links", refused: "refused", feature: "features", edge: "edges",
  hole: "holes",
};
const kinds = Object.keys(titles);

// The items of a kind, made when they are asked for.
export function itemsOf(mesh, kind) {
  return mesh.items[kind] ??= makers[kind](mesh);
}

const makers = {
  relay: (mesh) => mesh.relays.map((relay) => pointItem("relay", relay)),
  hole: (mesh) => mesh.holes.map((hole) => pointItem("hole", hole)),
  gap: (mesh) => mesh.gaps.map((line) => lineItem(mesh, "gap", line)),
  link: (mesh) => mesh.longLinks.map((line) => lineItem(mesh, "link", line)),
  feature: (mesh) => mesh.features.map((line) => lineItem(mesh, "feature", line)),
  edge: (mesh) => mesh.edges.map((line) => lineItem(mesh, "edge", line)),
  refused: (mesh) => mesh.inactive.filter((feature) => feature.refused).flatMap((feature) => {
    const line = [placeOfEnd(mesh, feature.from), placeOfEnd(mesh, feature.to)];
    return line.every(Boolean) ? [lineItem(mesh, "refused", line, feature)] : [];
  }),
};

function pointItem(kind, point) {
  return { ...point, kind, isItem: true, hasPlace: true, key: `${kind} ${point.x} ${point.y}` };
}

function lineItem(mesh, kind, line, more = {}) {
  const [[fromX, fromY], [toX, toY]] = line;
  return {
    ...more, kind, line, isItem: true, hasPlace: true, key: `${kind} ${line.join(" ")}`,
    x: (fromX + toX) / 2, y: (fromY + toY) / 2, length: Math.hypot(toX - fromX, toY - fromY),
    ends: line.map(([x, y]) => mesh.byPlace.get(`${x},${y}`)),
  };
}

// "node 1001 – anchor (0, 20)"
export function endsText(mesh, { from, to }) {
  const text = (end) => (Array.isArray(end) ? `anchor (${end.join(", ")})`
    : lowered(mesh.bySerial.has(end) ? nameOf(mesh.bySerial.get(end)) : `Node ${end}`));
  return `${text(from)} – ${text(to)}`;
}

function lowered(text) { return text[0].toLowerCase() + text.slice(1); }

function betweenText(mesh, item) {
  if (item.from !== undefined) return endsText(mesh, item);
  return item.ends.map((end) => (end ? lowered(nameOf(end)) : "a place that is gone")).join(" – ");
}

function whereText(item) { return item.feature ? `on feature ${featureText(item)}` : "at an anchor"; }

export function titleOf(item) {
  if (item.kind === whole) return `Feature ${featureText(item)}`;
  return item.kind === "refused" ? `Feature ${featureText(item)} refused` : titles[item.kind];
}

// What is to be said of it, as [name, text].
export function itemFacts(mesh, item) {
  const length = (value) => lengthText(value, mesh.metresPerUnit);
  if (item.kind === "hole") {
    return [["Position", placeText(item)], ["Nearest node", length(item.distance)],
      ["Sensing range", length(mesh.sensingRange)]];
  }
  if (item.kind === whole) return wholeFacts(mesh, item);
  if (item.kind === "relay") return [["Position", placeText(item)], ["Where", whereText(item)]];
  const facts = [["Between", betweenText(mesh, item)], ["Length", length(item.length)]];
  const along = item.kind === "feature" || item.kind === "gap" ? featureAlong(mesh, item.line) : undefined;
  if (along) facts.unshift(["Feature", featureName(along)]);
  if (item.kind === "link") facts.push(["Radio range", length(mesh.radioRange)]);
  if (item.kind === "gap") facts.push(["Sensing range", length(mesh.sensingRange)]);
  if (item.refused) {
    const told = featureOf(item.feature);
    facts.push(["Why", told?.why ?? item.refused]);
    if (told?.cure) facts.push(["What to do", told.cure]);
    if (meetingText(told)) facts.push(["They meet at", meetingText(told)]);
  }
  if (item.blocker) facts.push(["In its way", blockerText(item)]);
  return facts;
}

// One line of it.
export function itemText(mesh, item) {
  const facts = itemFacts(mesh, item);
  const told = facts[0][0] === "Feature" ? 3 : 2;
  return `${titleOf(item)}: ${facts.map(([, text]) => text).slice(0, told).join(", ")}`;
}

// A feature by its number, whether it is refused, in the mesh, or waits and may have no place; null
// where there is none of it.
export function featureItem(mesh, number) {
  const refused = itemsOf(mesh, "refused").find((item) => item.feature === number);
  if (refused) return refused;
  const told = featureOf(number);
  if (!told) return null;
  const line = lineOf(mesh, told);
  const more = { feature: number, feature_name: told.name, from: told.from, to: told.to };
  if (line) return lineItem(mesh, whole, line, more);
  const ends = [told.from, told.to].map((end) => mesh.bySerial.get(end) ?? mesh.byPlace.get(String(end)));
  return { ...more, kind: whole, isItem: true, hasPlace: false, key: `${whole} ${number}`, ends };
}

function wholeFacts(mesh, item) {
  const told = featureOf(item.feature);
  const facts = [["State", !told ? "–" : told.in_mesh ? "in the mesh" : "waits"], ["Between", endsText(mesh, item)]];
  if (item.line) facts.push(["Length", lengthText(item.length, mesh.metresPerUnit)]);
  if (told?.why) facts.push(["Why", told.why]);
  if (told?.cure) facts.push(["What to do", told.cure]);
  return facts;
}

// The same in a newer mesh, or null.
export function sameItem(mesh, item) {
  if (item.kind === whole) return featureItem(mesh, item.feature);
  return itemsOf(mesh, item.kind).find((other) => other.key === item.key) ?? null;
}

// The nearest item to a place that is no farther than `reach` (units of the mesh), of the kinds for
// which `isOn` holds; or null.
export function itemAt(mesh, place, reach, isOn) {
  for (const kind of kinds) {
    if (!isOn(layerOfItem[kind])) continue;
    let best = null;
    let bestDistance = reach;
    for (const item of itemsOf(mesh, kind)) {
      const distance = distanceTo(mesh, item, place);
      if (distance < bestDistance) [best, bestDistance] = [item, distance];
    }
    if (best) return best;
  }
  return null;
}

function distanceTo(mesh, item, { x, y }) {
  if (item.line) return distanceToLine(item.line, x, y);
  const distance = Math.hypot(item.x - x, item.y - y);
  return item.kind === "hole" ? Math.max(0, distance - holeRadius(mesh, item)) : distance;
}

export function holeRadius(mesh, hole) { return Math.max(0, hole.distance - mesh.sensingRange); }

function distanceToLine([[fromX, fromY], [toX, toY]], x, y) {
  const [dx, dy] = [toX - fromX, toY - fromY];
  const square = dx * dx + dy * dy;
  const along = square > 0 ? Math.min(1, Math.max(0, ((x - fromX) * dx + (y - fromY) * dy) / square)) : 0;
  return Math.hypot(fromX + along * dx - x, fromY + along * dy - y);
}
