// Everything beside the map and the table: counts, details of a point, events, buses, legend.
import {
  ageText, degreesText, nameOf, placeText, sinceText, stateInWords, timeText, whereText,
} from "./model.js";
import { layers } from "./map.js";
import { decimal, isFresh, quantityText, readingsOf, valueText } from "./readings.js";

const byId = (id) => document.getElementById(id);

function element(tag, text, className) {
  const made = document.createElement(tag);
  if (text !== undefined) made.textContent = text;
  if (className) made.className = className;
  return made;
}

function showState(colour, words) {
  const state = byId("state");
  state.className = `chip ${colour}`;
  // A screen reader says it again only when it is another.
  if (state.textContent !== words) state.textContent = words;
}

export function showNoAnswer() {
  showState("bad", "No answer");
}

export function showStatus(status) {
  showState(...stateInWords(status));
  const counts = [
    ["Generation", status.generation],
    ["Nodes", status.nodes],
    ["Relay proposals", status.steiner_vertices],
    ["Edges", status.edges],
    ["Triangles", status.triangles],
    ["Features", status.features_active === status.features_configured ? status.features_active
      : `${status.features_active} of ${status.features_configured}`],
  ];
  byId("counts").replaceChildren(...counts.map(([name, value]) => {
    const pair = element("div");
    pair.append(element("dt", name), element("dd", value));
    return pair;
  }));
  byId("version").textContent = `version ${status.version}, up ${ageText(status.uptime_ms)}`;
}

const meterMs = 10000;   // until then nothing has been measured

export function showBuses(status) {
  byId("buses").replaceChildren(...status.buses.map((bus) => {
    const item = element("li");
    item.append(element("b", bus.name), bus.silent_ms === undefined
      ? element("span", `${bus.answering} of ${bus.units} units answer`,
        bus.answering === 0 ? "stale" : undefined)
      : element("span", `silent since ${sinceText(bus.silent_ms)}`, "stale"));
    if (status.uptime_ms > meterMs) {
      item.append(element("span", `in use ${Math.round(bus.utilisation * 100)} %`));
    }
    if (bus.efficiency > 0) {
      item.append(element("span", `efficiency ${Math.round(bus.efficiency * 100)} %`));
    }
    return item;
  }));
}

// Nodes that fell silent and left the mesh for that; `go` is called with the serial that was clicked.
export function showMissing(entries, go) {
  byId("missing").hidden = entries.length === 0;
  byId("missing-title").textContent = `Missing (${entries.length})`;
  const list = byId("missed");
  const key = entries.map((entry) => entry.serial).join();
  // The buttons stay while they are the same, so that a click and the focus outlive the times.
  if (list.dataset.shown !== key) {
    list.dataset.shown = key;
    list.replaceChildren(...entries.map((entry) => {
      const item = element("li");
      const button = element("button", `Node ${entry.serial}`);
      button.addEventListener("click", () => go(entry.serial));
      item.append(button, element("span"));
      return item;
    }));
  }
  entries.forEach((entry, at) => {
    const where = entry.bus === undefined ? "" : `unit ${whereText(entry)}, `;
    list.children[at].lastChild.textContent = `${where}since ${sinceText(entry.since_ms)}`;
  });
}

// What the mesh does not take, and why; `go` is called with the serial that was clicked.
export function showQuarantine(entries, go) {
  byId("quarantine").hidden = entries.length === 0;
  byId("quarantine-title").textContent = `In quarantine (${entries.length})`;
  const key = JSON.stringify(entries.map(({ since_ms, ...rest }) => rest));
  const list = byId("refused");
  if (list.dataset.shown === key) return;
  list.dataset.shown = key;
  list.replaceChildren(...entries.map((entry) => {
    const item = element("li");
    const name = entry.feature ? `Feature ${entry.feature}` : `Node ${entry.serial}`;
    if (entry.feature) {
      item.append(element("b", name));
    } else {
      const button = element("button", name);
      button.addEventListener("click", () => go(entry.serial));
      item.append(button);
    }
    const where = entry.bus === undefined ? "" : `unit ${whereText(entry)}: `;
    item.append(element("span", where + entry.why));
    return item;
  }));
}

let newestEvent = 0;
let eventsOf = "";

// Newest first; the list is made anew only when there is a new one.
export function showEvents(status) {
  const newest = status.events[0]?.number ?? 0;
  if (newest === newestEvent && eventsOf === status.instance) return;
  newestEvent = newest;
  eventsOf = status.instance;
  byId("events").replaceChildren(...status.events.map((event) => {
    const item = element("li");
    item.append(element("time", timeText(event.age_ms)),
      element("span", event.text, event.level));
    return item;
  }));
}

function whyText(node) {
  if (node.missing) return `no answer since ${sinceText(node.missingMs ?? 0)}`;
  if (node.refused) return node.refused;
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

// The details of a point; null closes them. `go` is called with a neighbour that was clicked.
export function showDetails(point, mesh, readings, go) {
  byId("details").hidden = !point;
  if (!point) return;
  byId("details-title").textContent = nameOf(point);
  const facts = [["Place", placeText(point)], ["Neighbours", point.neighbours.length]];
  const degrees = degreesText(point);
  if (degrees) facts.splice(1, 0, ["Degrees", degrees]);
  if (point.isNode) {
    const state = element("span", point.state, `mark ${point.state}`);
    facts.unshift(["State", state],
      ["Last position", point.ageMs === undefined ? "none" : `${ageText(point.ageMs)} ago`],
      ["Unit, bus", whereText(point)]);
    const why = whyText(point);
    if (why) facts.splice(1, 0, ["Why", why]);
    for (const [quantity, reading] of readingsOf(readings, point.serial)) {
      facts.push([quantity.name, readingText(quantity, reading)]);
    }
  } else {
    facts.unshift(["What", "a place for a relay"], ["On feature", point.feature]);
  }
  byId("facts").replaceChildren(...facts.flatMap(([name, value]) => {
    const content = element("dd");
    content.append(value);
    return [element("dt", name), content];
  }));
  byId("neighbours-title").hidden = point.neighbours.length === 0;
  const shown = point.neighbours.join();
  const list = byId("neighbours");
  // Left alone while it is the same, so that a button keeps the focus.
  if (list.dataset.shown === `${mesh.generation}:${point.id}:${shown}`) return;
  list.dataset.shown = `${mesh.generation}:${point.id}:${shown}`;
  list.replaceChildren(...point.neighbours.map((id) => mesh.points.get(id)).filter(Boolean)
    .map((other) => {
      const item = element("li");
      const text = other.kind === "anchor" ? `anchor (${other.x}, ${other.y})` : `relay ${other.id}`;
      const button = element("button", other.isNode ? other.serial : text,
        other.kind === "steiner" ? "steiner" : "");
      button.addEventListener("click", () => go(other));
      item.append(button);
      return item;
    }));
}

// What can be shown on the map; the choice stays where it can.
export function showQuantities(readings) {
  byId("measured").hidden = !readings;
  const texts = readings?.quantities.map(quantityText) ?? [];
  const list = byId("quantity");
  const key = texts.join("\n");
  if (list.dataset.shown === key) return;
  list.dataset.shown = key;
  list.replaceChildren(new Option("No readings", ""),
    ...texts.map((text, index) => new Option(text, String(index))));
}

// The bands of the quantity on the map, the highest first, and how many nodes have a value.
export function showBands(map, readings) {
  const { shading } = map;
  byId("measured-count").textContent = shading && readings ? countText(shading) : "";
  byId("bands").replaceChildren(...(shading ? bandRows(map) : []));
  map.view.setCovered(shading ? byId("measured").offsetWidth : 0);
}

function bandRows(map) {
  const { shading } = map;
  if (shading.bounds.length === 0) return [];
  const { bounds, digits, quantity } = shading;
  const [first] = bounds;
  const texts = bounds.length === 1 ? [valueText(first, quantity.unit, digits)]
    : bounds.slice(1).map((bound, band) =>
      `${decimal(bounds[band], digits)} … ${valueText(bound, quantity.unit, digits)}`);
  const colours = map.areaColours(shading.bandCount);
  return texts.map((text, band) => {
    const item = element("li");
    const sample = element("span");
    sample.style.background = colours[band];
    item.append(sample, text);
    return item;
  }).reverse();
}

function countText(shading) {
  const readings = [...shading.ofSerial.values()];
  const stale = readings.filter((reading) => reading.isStale).length;
  const fresh = readings.filter(isFresh).length;
  const parts = [`${fresh} ${fresh === 1 ? "node" : "nodes"}`];
  if (stale > 0) parts.push(`${stale} stale`);
  if (readings.length > fresh + stale) parts.push(`${readings.length - fresh - stale} without a value`);
  return parts.join(", ");
}

export function makeLegend(map) {
  for (const layer of layers) {
    const label = element("label");
    const box = element("input");
    box.type = "checkbox";
    box.checked = layer.on;
    box.addEventListener("change", () => {
      layer.on = box.checked;
      map.redraw();
    });
    layer.sample = element("canvas");
    layer.count = element("output", "0");
    layer.label = label;
    label.append(box, layer.sample, element("span", layer.text), layer.count);
    byId("legend").append(label);
  }
  drawLegend(map);
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => drawLegend(map));
}

function drawLegend(map) {
  for (const layer of layers) map.drawSample(layer.sample, layer.name);
}

export function countLegend(mesh) {
  const count = {
    holes: mesh.holes.length,
    edges: mesh.edges.length + mesh.features.length,
    links: mesh.longLinks.length,
    features: mesh.features.length,
    gaps: mesh.gaps.length,
    refused: mesh.inactive.filter((feature) => feature.refused).length,
    steiner: mesh.steiner.length + mesh.relays.length,
  };
  for (const node of mesh.nodes) count[node.state] = (count[node.state] ?? 0) + 1;
  for (const layer of layers) {
    layer.count.textContent = count[layer.name] ?? 0;
    layer.label.classList.toggle("none", !count[layer.name]);
  }
}
