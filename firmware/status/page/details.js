// The details of what was chosen: a node, a vertex of the mesh, or another item of the map.
import { byId, element, linked } from "./dom.js";
import { itemFacts, titleOf } from "./items.js";
import {
  ageText, calledText, degreesText, featureText, leftText, nameOf, placeText, sinceText, whereText, wordOfState,
} from "./model.js";
import { endOf, readingsOf, valueText } from "./readings.js";
import { conditionsOf, errorsText, stateText } from "./units.js";

function whyText(node) {
  if (node.never_heard) return "it has not answered since the start";
  if (node.missing) return `no answer since ${sinceText(node.missingMs ?? 0, `node ${node.serial}`)}`;
  if (node.left) return `it has said that it leaves; ${leftText(node)}`;
  if (node.refused) return node.refused;
  if (node.far) return "it stands far from all others";
  return node.no_fix ? "it answers, but has no fix" : "";
}

function readingText({ unit }, reading) {
  const age = reading.isStale ? `stale, ${ageText(reading.ageMs)} old` : `${ageText(reading.ageMs)} ago`;
  const content = element("span");
  content.append(element("span", `${valueText(reading.value, unit)}, ${age}`, reading.isStale ? "stale" : undefined));
  if (reading.expected !== null) {
    const expected = `expected ${valueText(Number(reading.expected.toPrecision(5)), unit)}`;
    content.append(element("br"), element("span", expected, reading.disagrees ? "quarantined" : undefined));
  }
  return content;
}

function nodeFacts(node, readings) {
  const link = element("a", `#node=${node.serial}`);
  link.href = `#node=${node.serial}`;
  const facts = [["State", element("span", wordOfState(node.state), `mark ${node.state}`)]];
  const why = whyText(node);
  if (why) facts.push(["Why", why]);
  facts.push(["Position told", node.ageMs === undefined ? "none" : `${ageText(node.ageMs)} ago`],
    node.owner === undefined ? ["Unit, bus", whereText(node)] : ["Heard by", node.owner],
    ...placeFacts(node), ...unitFacts(node), ["Link to it", link]);
  for (const [quantity, reading] of readingsOf(readings, node.serial)) {
    facts.push([quantity.name, readingText(quantity, reading)]);
  }
  return facts;
}

// Of the unit where it was heard last. Until the gateway has said how that is the lines are there all
// the same: what stands below does not move away from under a finger.
function unitFacts(node) {
  if (node.bus === undefined) return [];
  const unit = node.heardBy;
  if (unit === null) return [["Its unit", "nobody has answered there since the start"]];
  if (!unit) return ["It says", "Its unit", "Errors", "Answer in"].map((name) => [name, "…"]);
  const isThere = unit.serial === node.serial;
  const answer = unit.answer_ms === undefined ? "–"
    : `${unit.answer_ms} ms; mean ${unit.answer_mean_ms} ms, longest ${unit.answer_longest_ms} ms`;
  const facts = [["It says", isThere && unit.said_ms !== undefined ? saidText(unit) : "–"], ["Its unit", stateText(unit)],
    ["Errors", errorsText(unit, ` of the last ${unit.recent} questions`)], ["Answer in", answer]];
  if (!isThere && unit.serial !== undefined) facts.push(["There now", `node ${calledText(unit.serial, unit.name)}`]);
  if (unit.no_position) facts.push(["No position", `it ${unit.no_position}`]);
  if (unit.last_error_text && unit.state !== "answering") facts.push(["What is wrong", unit.last_error_text]);
  if (unit.profile) facts.push(["Profile", unit.profile]);
  return facts;
}

function saidText(unit) {
  const said = element("span");
  const conditions = conditionsOf(unit);
  if (!unit.no_fix) said.append(unit.surveyed ? "surveyed" : "it has a fix", conditions.length > 0 ? ", " : "");
  said.append(element("span", conditions.join(", "), unit.no_fix || unit.low_battery ? "stale" : undefined),
    `, ${ageText(unit.said_ms)} ago`);
  return said;
}

function placeFacts(point) {
  const degrees = degreesText(point);
  const facts = [["Position", placeText(point)]];
  if (degrees) facts.push(["Degrees", degrees]);
  facts.push(["Neighbours", point.neighbours.length]);
  return facts;
}

function vertexFacts(point, mesh) {
  if (point.kind === "anchor") return [["What", "an anchor: a fixed point of the site"], ...placeFacts(point)];
  const ends = (point.along ?? []).map((id) => mesh.points.get(endOf(mesh, point, id)?.id)).filter(Boolean);
  const between = ends.length === 2 ? `, ${ends.map(nameOf).join(" – ")}` : "";
  return [["What", "a place for a relay (Steiner vertex)"], ["On feature", `${featureText(point)}${between}`], ...placeFacts(point)];
}

function factsOf(point, mesh, readings) {
  if (point.isItem) return itemFacts(mesh, point);
  return point.isNode ? nodeFacts(point, readings) : vertexFacts(point, mesh);
}

// Null closes them. `go` is called with a neighbour that was clicked.
export function showDetails(point, mesh, readings, go) {
  byId("details").hidden = !point;
  if (!point) return;
  byId("details-title").textContent = point.isItem ? titleOf(point) : nameOf(point);
  byId("facts").replaceChildren(...factsOf(point, mesh, readings).flatMap(([name, value]) => {
    const content = element("dd");
    content.append(...(typeof value === "string" ? linked(value) : [value]));
    return [element("dt", name), content];
  }));
  showNeighbours(point, mesh, go);
}

// Those of a vertex; of a line its ends.
function showNeighbours(point, mesh, go) {
  const others = point.isItem ? (point.ends ?? []).filter(Boolean)
    : point.neighbours.map((id) => mesh.points.get(id)).filter(Boolean);
  byId("neighbours-title").hidden = others.length === 0;
  byId("neighbours-title").textContent = point.isItem ? "Ends" : "Neighbours";
  const key = `${mesh.generation}:${point.key ?? point.id}:${others.map((other) => other.id).join()}`;
  const list = byId("neighbours");
  // Left alone while it is the same, so that a button keeps the focus.
  if (list.dataset.shown === key) return;
  list.dataset.shown = key;
  list.replaceChildren(...others.map((other) => {
    const item = element("li");
    const button = element("button", shortName(other), other.kind === "steiner" ? "steiner" : "");
    button.addEventListener("click", () => go(other));
    item.append(button);
    return item;
  }));
}

function shortName(point) {
  if (point.isNode) return calledText(point.serial, point.name);
  return point.kind === "anchor" ? `anchor (${point.x}, ${point.y})` : `relay ${point.id}`;
}
