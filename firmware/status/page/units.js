// What is said of a unit, and how it is found. Knows nothing of the screen.
import { ageText, dateOf, momentText, sinceText } from "./model.js";

// Reads units.json, which was asked for when the gateway said `status`.
export function readUnits(json, status) {
  return json.units.map((unit) => ({ ...unit, uptimeMs: status.uptime_ms }));
}

// Gives each node the unit where it was heard last.
export function setUnits(mesh, units) {
  const byPlace = new Map(units.map((unit) => [`${unit.unit} ${unit.bus}`, unit]));
  for (const node of mesh.nodes) {
    node.heardBy = node.bus === undefined ? undefined : byPlace.get(`${node.unit} ${node.bus}`) ?? null;
  }
}

// What needs somebody first. Those that are in trouble: who fell silent last, first.
const order = ["silent", "faulty", "earlier", "never", "unheard", "answering"];

// One of a range that nobody has ever answered at may well not exist.
export function isUnheard(unit) {
  return unit.state === "silent" && unit.since_ms === undefined && !unit.answered_before && !unit.name;
}

// Its node has said that it leaves, and is silent since: nobody has to look at it.
export function hasGone(unit) { return Boolean(unit.left) && unit.state === "silent"; }

function rankOf(unit) {
  if (hasGone(unit)) return order.indexOf("answering");
  if (isUnheard(unit)) return order.indexOf("unheard");
  if (unit.state !== "silent" || unit.since_ms !== undefined) return order.indexOf(unit.state);
  return order.indexOf(unit.answered_before ? "earlier" : "never");
}

function troubleMs(unit) {
  return unit.state === "answering" ? 0 : unit.since_ms ?? Number.MAX_SAFE_INTEGER;
}

export function byUrgency(a, b) {
  return rankOf(a) - rankOf(b) || troubleMs(a) - troubleMs(b) || a.unit - b.unit;
}

// Who is silent is looked for in what happened then; who answers has done so for a while.
export function stateText(unit) {
  if (unit.state === "answering") return `answering for ${ageText(unit.since_ms)}`;
  if (unit.since_ms !== undefined) return `${unit.state} since ${sinceText(unit.since_ms, `node ${unit.serial}`)}`;
  if (unit.state === "faulty") return "faulty since the start";
  const start = momentText(dateOf(unit.uptimeMs));
  return unit.answered_before ? `silent, not heard since the start of the gateway, ${start}`
    : `has not answered since the start, ${start}`;
}

// Of the latest questions, `of` behind their part, and what was wrong last.
export function errorsText(unit, of = "") {
  if (!unit.recent) return "–";
  const part = `${Math.round(100 * unit.recent_errors / unit.recent)} %${of}`;
  if (!unit.last_error) return part;
  const what = unit.exception === undefined ? unit.last_error : `${unit.last_error} ${unit.exception}`;
  return `${part}, ${what} ${ageText(unit.last_error_ms)} ago`;
}

// What a node says of itself.
export function conditionsOf(unit) {
  return [unit.left && "has left", unit.low_battery && "low battery", unit.moving && "moving", unit.no_fix && "no fix"].filter(Boolean);
}

// The same of a node, with what its unit says of it now; another node may answer there by now.
export function conditionsOfNode(node) {
  const isThere = node.heardBy?.serial === node.serial;
  const conditions = isThere ? conditionsOf(node.heardBy) : [];
  if (node.no_fix && !conditions.includes("no fix")) conditions.push("no fix");
  if (node.lowBattery && !conditions.includes("low battery")) conditions.push("low battery");
  if (node.missing || isThere && node.heardBy.state !== "answering") {
    conditions.push(node.missing ? "silent" : node.heardBy.state);
  }
  return conditions;
}

export function notesOf(unit) { return [unit.profile, ...conditionsOf(unit)].filter(Boolean); }

// What somebody has typed, as words; "unit 8" is one.
export function wordsOf(text) {
  return text.toLowerCase().replace(/\bunit\s+(?=\d)/g, "unit:").split(/\s+/).filter(Boolean);
}

// The unit that such a word asks for, or null.
export function unitIn(word) {
  const found = /^unit:(\d+)$/.exec(word);
  return found ? Number(found[1]) : null;
}

// Whether one of the words is all of its number: that is more than a part of one.
export function isExactly(words, ...numbers) {
  return words.some((word) => numbers.includes(unitIn(word) ?? (/^\d+$/.test(word) ? Number(word) : undefined)));
}

// A number is a unit, or a part of a serial or of a name.
export function matchesUnit(unit, word) {
  const name = (unit.name ?? "").toLowerCase();
  if (unitIn(word) !== null) return unit.unit === unitIn(word);
  if (/^\d+$/.test(word)) {
    return String(unit.unit) === word || String(unit.serial ?? "").includes(word) || name.includes(word);
  }
  const state = isUnheard(unit) ? "unheard" : unit.state;
  return [name, unit.bus, state, unit.last_error ?? "", ...notesOf(unit)]
    .some((text) => text.toLowerCase().includes(word));
}
