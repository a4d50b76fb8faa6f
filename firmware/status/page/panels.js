// Counts, lists of what is wrong, events, quantities, legend.
import { stateInWords } from "./banner.js";
import { byId, element, linked, setText, showRows } from "./dom.js";
import { endsText } from "./items.js";
import { keepLayers, keptLayers } from "./keep.js";
import { layers } from "./map.js";
import { ageText, calledText, dateOf, momentText, sinceText, whereText } from "./model.js";
import { decimal, isFresh, quantityText, valueText } from "./readings.js";

function showState(colour, words) {
  const state = byId("state");
  state.className = `chip ${colour}`;
  // A screen reader says it again only when it is another.
  if (state.textContent !== words) state.textContent = words;
}

// Without a radio range they are the Steiner vertices.
function relayCount(status) { return status.radio_range > 0 ? status.relays : status.steiner_vertices; }

export function showNoAnswer() {
  showState("critical", "No answer");
}

// `alarms` as alarms.json has them.
export function showStatus(status, alarms) {
  // Of several gateways in several tabs.
  document.title = status.name ? `${status.name} – ETCM gateway` : "ETCM gateway";
  document.querySelector("h1").textContent = status.name || "ETCM gateway";
  showState(...stateInWords(status, alarms));
  showNotice(status);
  const counts = [
    ["Version (generation)", status.generation],
    ["Nodes", status.nodes],
    ["Proposed relays", relayCount(status)],
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

// What is no trouble, and wants to be known.
export function showNotice(status) {
  const keys = status.needs_restart ?? [];
  byId("notice").hidden = keys.length === 0;
  if (keys.length === 0) return;
  setText(byId("notice"), `Waits for a restart: ${keys.join(", ")}. Changed in ${status.config}, and not in force before: ` +
    "sudo systemctl restart etcm-gateway");
}

// Nodes that fell silent and left the mesh for that; `go` is called with the serial that was clicked.
export function showMissing(entries, go) {
  byId("missing").hidden = entries.length === 0;
  byId("missing-title").textContent = `Missing (${entries.length})`;
  const list = byId("missed");
  const key = entries.map((entry) => calledText(entry.serial, entry.name)).join();
  // The buttons stay while they are the same, so that a click and the focus outlive the times.
  if (list.dataset.shown !== key) {
    list.dataset.shown = key;
    list.replaceChildren(...entries.map((entry) => {
      const item = element("li");
      const button = element("button", `Node ${calledText(entry.serial, entry.name)}`);
      button.addEventListener("click", () => go(entry.serial));
      item.append(button, element("span"));
      return item;
    }));
  }
  entries.forEach((entry, row) => {
    const at = entry.bus === undefined ? "" : `unit ${whereText(entry)}, `;
    const where = entry.gateway === undefined ? at : `of gateway ${entry.gateway}, `;
    list.children[row].lastChild.textContent = `${where}since ${sinceText(entry.since_ms, `node ${entry.serial}`)}`;
  });
}

// What the mesh does not take, and why; `go` is called with the serial that was clicked.
export function showQuarantine(entries, mesh, go) {
  byId("quarantine").hidden = entries.length === 0;
  byId("quarantine-title").textContent = `In quarantine (${entries.length})`;
  const key = JSON.stringify([mesh.generation, ...entries.map(({ since_ms, ...rest }) => rest)]);
  const list = byId("refused");
  if (list.dataset.shown === key) return;
  list.dataset.shown = key;
  list.replaceChildren(...entries.map((entry) => {
    const item = element("li");
    const feature = mesh.inactive.find((other) => other.feature === entry.feature);
    const name = entry.feature ? featureName(entry, feature, mesh)
      : `Node ${calledText(entry.serial, entry.name)}`;
    if (entry.feature) {
      item.append(element("b", name));
    } else {
      const button = element("button", name);
      button.addEventListener("click", () => go(entry.serial));
      item.append(button);
    }
    const where = entry.bus === undefined ? "" : `unit ${whereText(entry)}: `;
    const why = element("span");
    why.append(...linked(`${where}${entry.why}`));
    item.append(why);
    return item;
  }));
}

// "Feature 2 (node 1001 – node 1003)"
function featureName(entry, feature, mesh) {
  return `Feature ${calledText(entry.feature, entry.name)}${feature ? ` (${endsText(mesh, feature)})` : ""}`;
}

// Nodes for which features wait and that nobody has ever heard.
export function showUnheard(entries) {
  byId("unheard").hidden = entries.length === 0;
  byId("unheard-title").textContent = `Waited for (${entries.length})`;
  const list = byId("never");
  showRows(list, entries, (entry) => String(entry.serial), () => element("li"));
  entries.forEach((entry, at) => setText(list.children[at], entry.why));
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
    const time = element("time", momentText(dateOf(event.age_ms)));
    time.dateTime = dateOf(event.age_ms).toISOString();
    const text = element("span", "", event.level);
    text.append(...linked(event.text));
    item.append(time, text);
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
  const kept = keptLayers();
  for (const layer of layers) {
    const label = element("label");
    const box = element("input");
    box.type = "checkbox";
    layer.on = kept[layer.name] ?? layer.on;
    box.checked = layer.on;
    box.addEventListener("change", () => {
      layer.on = box.checked;
      keepLayers(layers);
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

export function drawLegend(map) {
  for (const layer of layers) map.drawSample(layer.sample, layer.name);
}

export function countLegend(mesh, status) {
  const count = {
    plan: status.plan ? 1 : 0,
    holes: mesh.holes.length,
    edges: mesh.edges.length + mesh.features.length,
    links: mesh.longLinks.length,
    features: mesh.features.length,
    gaps: mesh.gaps.length,
    refused: mesh.inactive.filter((feature) => feature.refused).length,
    steiner: relayCount(status),
  };
  for (const node of mesh.nodes) count[node.state] = (count[node.state] ?? 0) + 1;
  count.battery = mesh.nodes.filter((node) => node.lowBattery).length;
  for (const layer of layers) {
    layer.count.textContent = count[layer.name] ?? 0;
    layer.label.classList.toggle("none", !count[layer.name]);
  }
}
