// Draws the mesh, and knows what is under the pointer.
import { memberColours } from "./fleet.js";
import { holeRadius, itemAt, itemsOf, itemText } from "./items.js";
import { placeLabels } from "./labels.js";
import { featureText, lengthText, nameOf, wordOfState } from "./model.js";
import { Plan } from "./plan.js";
import { isFresh, valueText } from "./readings.js";
import { bandColours, rampNames } from "./shading.js";
import { diamond, isOutline, lowBattery, nodeShape } from "./shapes.js";
import { View } from "./view.js";

// What can be shown or not, bottom first.
export const layers = [
  { name: "plan", text: "Plan", on: true },
  { name: "holes", text: "Coverage holes", on: true },
  { name: "edges", text: "Edges", on: true },
  { name: "links", text: "Links too long", on: true },
  { name: "features", text: "Feature edges", on: true },
  { name: "gaps", text: "Barrier gaps", on: true },
  { name: "refused", text: "Features refused", on: true },
  { name: "steiner", text: "Proposed relays", on: true },
  { name: "fresh", text: "Fresh", on: true },
  { name: "ageing", text: "Ageing", on: true },
  { name: "stale", text: "Stale", on: true },
  { name: "quarantined", text: "In quarantine", on: true },
  { name: "left", text: "Has left", on: true },
  { name: "missing", text: "Missing", on: true },
  { name: "battery", text: "Low battery", on: true },
];

const hitDistance = 14;       // pixels
const lineHitDistance = 7;
const paperRatio = 3;         // of the points of paper to those of the screen
const labelledNodesMax = 150;   // those of the others that need somebody are named first
const obstaclesMax = 1000;      // points that names keep away from
const areaPart = 0.62;        // of the colour of a value where it fills an area below lines

export class MeshMap {
  // `chosen` is called with the point that was clicked, or null.
  constructor(canvas, { chosen }) {
    this.canvas = canvas;
    this.context = canvas.getContext("2d");
    this.mesh = null;
    this.shading = null;
    this.members = new Map();
    this.plan = new Plan(() => this.redraw());
    this.choice = null;
    this.hover = null;
    this.tip = document.getElementById("tip");
    this.scaleBar = document.getElementById("scale");
    this.view = new View(canvas, {
      changed: () => this.redraw(),
      clicked: (at) => chosen(this.foundAt(at)),
      hovered: (at) => this.setHover(at),
    });
    this.readColours();
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
      this.readColours();
      this.redraw();
    });
    new ResizeObserver(() => this.resize()).observe(canvas);
    this.resize();
  }

  setMesh(mesh) {
    this.mesh = mesh;
    this.spacing = spacingOf(mesh);
    this.hover = null;
    this.view.setBounds(mesh.bounds);
    this.redraw();
  }

  // The quantity to be shown (shading.js), or null.
  setShading(shading) {
    this.shading = shading;
    this.redraw();
  }

  // The colour of the fresh nodes of each gateway by its name, that of our own under "".
  setMembers(colours) { this.members = colours; }

  setChoice(point) {
    this.choice = point;
    if (point?.hasPlace) this.view.show(point);
    this.redraw();
  }

  // Paper has the colours of the day, and a size of its own; it does not wait for the next picture.
  setPaper(isOnPaper) {
    const { view } = this;
    if (isOnPaper) this.onScreen = { scale: view.scale, center: view.center, width: view.width };
    this.isOnPaper = isOnPaper;
    this.readColours();
    this.resize();
    if (isOnPaper && !view.followsBounds) view.scale *= view.width / this.onScreen.width;
    if (!isOnPaper && !view.followsBounds) Object.assign(view, { scale: this.onScreen.scale, center: this.onScreen.center });
    this.draw();
  }

  // At most once for each picture the screen shows.
  redraw() {
    if (this.isDue) return;
    this.isDue = true;
    requestAnimationFrame(() => {
      this.isDue = false;
      this.draw();
    });
  }

  resize() {
    const ratio = this.isOnPaper ? paperRatio : window.devicePixelRatio || 1;
    this.canvas.width = Math.round(this.canvas.clientWidth * ratio);
    this.canvas.height = Math.round(this.canvas.clientHeight * ratio);
    if (this.view.followsBounds) this.view.fit();
    this.redraw();
  }

  readColours() {
    this.isNight = !this.isOnPaper && matchMedia("(prefers-color-scheme: dark)").matches;
    // As the colour of an element, which is that of the day or of the night; the property is both.
    const colour = (name) => {
      this.canvas.style.color = `var(--${name})`;
      return getComputedStyle(this.canvas).color;
    };
    this.colours = { text: colour("text"), dim: colour("dim"), back: colour("map-back"),
      accent: colour("accent") };
    for (const name of ["edge", "feature", "steiner", "fresh", "ageing", "stale", "quarantined",
      "missing", "left", "hole", "link", "battery"]) {
      this.colours[name] = colour(`map-${name}`);
    }
    this.ramp = rampNames().map(colour);
    this.ownColours = memberColours.map(colour);
  }

  // Of the bands of values.
  areaColours(count) { return bandColours(this.ramp, count, this.colours.back, areaPart); }

  isOn(name) { return layers.find((layer) => layer.name === name).on; }

  draw() {
    const { context, view, colours, mesh } = this;
    const ratio = this.canvas.width / Math.max(1, view.width);
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.clearRect(0, 0, view.width, view.height);
    if (!mesh) return;
    if (this.isOn("plan")) this.plan.draw(context, view, this.isNight);
    const radius = Math.min(6.5, Math.max(1.6, (this.spacing * view.scale) / 5));
    this.shading?.draw(context, (lines) => this.trace(lines),
      this.areaColours(this.shading.bandCount), colours.text);
    if (this.isOn("holes")) this.fillHoles();
    if (this.isOn("edges")) this.strokeLines(mesh.edges, colours.edge, 1);
    if (this.isOn("links")) this.strokeLines(mesh.longLinks, colours.link, 1.6, [6, 4]);
    if (this.isOn("features")) this.strokeLines(mesh.features, colours.feature, radius > 3 ? 3 : 1.8);
    if (this.isOn("gaps")) this.strokeLines(mesh.gaps, colours.hole, radius > 3 ? 5 : 3);
    if (this.isOn("refused")) this.drawRefused();
    this.drawChoiceLinks();
    if (this.isOn("steiner")) {
      this.drawDiamonds(mesh.steiner, Math.max(2, radius * 0.8));
      this.drawDiamonds(mesh.relays, Math.max(2, radius * 0.8));
    }
    for (const state of ["missing", "left", "fresh", "ageing", "stale", "quarantined"]) {
      if (!this.isOn(state)) continue;
      if (this.shading) this.drawValues(mesh.nodes, state, Math.max(3, radius));
      else this.drawNodes(mesh.nodes, state, radius);
    }
    if (this.isOn("battery")) this.drawBatteries(radius);
    this.drawRing(this.choice, radius + 5, 3);
    if (this.hover !== this.choice) this.drawRing(this.hover, radius + 4, 1.5);
    if (this.hover?.line) this.strokeLines([this.hover.line], colours.accent, 2);
    this.drawLabels(radius);
    this.drawScale();
  }

  trace(lines) {
    const { context, view } = this;
    context.beginPath();
    for (const line of lines) {
      context.moveTo(view.screenX(line[0][0]), view.screenY(line[0][1]));
      for (let i = 1; i < line.length; ++i) {
        context.lineTo(view.screenX(line[i][0]), view.screenY(line[i][1]));
      }
    }
  }

  strokeLines(lines, colour, width, dash = []) {
    this.trace(lines);
    this.context.setLineDash(dash);
    this.context.strokeStyle = colour;
    this.context.lineWidth = width;
    this.context.lineCap = "round";
    this.context.stroke();
    this.context.setLineDash([]);
  }

  // A disc as large as what is out of range there, and large enough to be seen.
  fillHoles() {
    const { context, view, mesh } = this;
    context.beginPath();
    for (const hole of mesh.holes) {
      const radius = Math.max(5, holeRadius(mesh, hole) * view.scale);
      const x = view.screenX(hole.x);
      context.moveTo(x + radius, view.screenY(hole.y));
      context.arc(x, view.screenY(hole.y), radius, 0, 2 * Math.PI);
    }
    context.globalAlpha = 0.35;
    context.fillStyle = this.colours.hole;
    context.fill();
    context.globalAlpha = 1;
  }

  // And where they meet what is in their way.
  drawRefused() {
    const { context, view, colours } = this;
    for (const { near } of itemsOf(this.mesh, "refused")) {
      if (!near) continue;
      const [x, y] = [view.screenX(near[0]), view.screenY(near[1])];
      context.beginPath();
      context.arc(x, y, 8, 0, 2 * Math.PI);
      nodeShape(context, "missing", x, y, 4);
      context.strokeStyle = colours.quarantined;
      context.lineWidth = 2;
      context.stroke();
    }
    this.strokeLines(itemsOf(this.mesh, "refused").map((item) => item.line), this.colours.quarantined, 2,
      [7, 5]);
  }

  drawChoiceLinks() {
    const { choice, mesh } = this;
    if (choice?.kind === "refused") return this.strokeLines([choice.line], this.colours.quarantined, 4, [7, 7]);
    if (choice?.line) return this.strokeLines([choice.line], this.colours.accent, 4);
    if (!choice?.hasPlace || !choice.neighbours) return;
    const lines = choice.neighbours.map((id) => mesh.points.get(id)).filter(Boolean)
      .map((other) => [[choice.x, choice.y], [other.x, other.y]]);
    this.strokeLines(lines, this.colours.accent, 2.5);
  }

  drawDiamonds(points, size) {
    const { context, view } = this;
    context.beginPath();
    for (const point of points) diamond(context, view.screenX(point.x), view.screenY(point.y), size);
    this.paint(this.colours.steiner);
  }

  drawNodes(nodes, state, radius) {
    const those = nodes.filter((node) => node.state === state && node.hasPlace);
    if (state !== "fresh" || this.members.size === 0) {
      return this.drawAlike(those, state, radius, this.colours[state]);
    }
    for (const [name, colour] of this.members) {
      const its = those.filter((node) => (node.owner ?? "") === name);
      this.drawAlike(its, state, radius, this.ownColours[colour]);
    }
  }

  drawAlike(nodes, state, radius, colour) {
    const { context, view, colours } = this;
    context.beginPath();
    for (const node of nodes) {
      nodeShape(context, state, view.screenX(node.x), view.screenY(node.y), radius);
    }
    if (isOutline(state)) {
      context.fillStyle = colours.back;
      context.fill();
      context.strokeStyle = colour;
      context.lineWidth = Math.max(1.5, radius / 2.5);
      context.stroke();
    } else {
      this.paint(colour);
    }
  }

  // Beside the node, above it to the left.
  drawBatteries(radius) {
    const { context, view, colours } = this;
    const size = Math.max(5, radius * 1.2);
    for (const node of this.mesh.nodes) {
      if (!node.lowBattery || !node.hasPlace || !this.isOn(node.state)) continue;
      lowBattery(context, view.screenX(node.x) - radius - size, view.screenY(node.y) - radius - size / 2, size, colours);
    }
  }

  // In the shape of the state and the colour of the value; without a fresh one it is empty.
  drawValues(nodes, state, radius) {
    const { context, view, colours, shading } = this;
    const fills = bandColours(this.ramp, shading.bandCount, colours.back, 1);
    context.lineWidth = 1.3;
    for (const node of nodes) {
      if (node.state !== state || !node.hasPlace) continue;
      const reading = shading.ofSerial.get(node.serial);
      context.beginPath();
      nodeShape(context, state, view.screenX(node.x), view.screenY(node.y), radius);
      context.fillStyle = isFresh(reading) ? fills[shading.band(reading.value)] : colours.back;
      context.strokeStyle = isFresh(reading) ? colours.text
        : reading?.isStale ? colours.stale : colours.dim;
      context.fill();
      context.stroke();
    }
  }

  // Filled, apart from what is below it.
  paint(colour) {
    this.context.fillStyle = colour;
    this.context.fill();
    this.context.strokeStyle = this.colours.back;
    this.context.lineWidth = 1;
    this.context.stroke();
  }

  drawRing(point, radius, width) {
    if (!point?.hasPlace || point.line) return;
    const { context, view } = this;
    const wide = point.kind === "hole" ? Math.max(radius, holeRadius(this.mesh, point) * view.scale) : radius;
    context.beginPath();
    context.arc(view.screenX(point.x), view.screenY(point.y), wide, 0, 2 * Math.PI);
    context.strokeStyle = this.colours.accent;
    context.lineWidth = width;
    context.stroke();
  }

  // Names or serials, and what is measured.
  drawLabels(radius) {
    const { context, view, mesh } = this;
    const seen = mesh.nodes.filter((node) => node.hasPlace && this.isSeen(node));
    context.font = "12px system-ui, 'DejaVu Sans', sans-serif";
    context.textBaseline = "top";
    context.strokeStyle = this.colours.back;
    context.fillStyle = this.colours.text;
    context.lineWidth = 3;
    context.lineJoin = "round";
    // What was chosen is named before all others, then who needs somebody, then who has a name.
    const rank = (node) => (node === this.choice ? 0 : node.state !== "fresh" || node.lowBattery ? 1
      : node.name ? 2 : 3);
    seen.sort((a, b) => rank(a) - rank(b));
    const labels = seen.slice(0, obstaclesMax).map((node, at) => ({ x: view.screenX(node.x),
      y: view.screenY(node.y), radius, ...(at < labelledNodesMax ? this.labelOf(node) : {}) }));
    const relays = this.isOn("steiner") ? [...mesh.steiner, ...mesh.relays].filter((relay) => this.isSeen(relay)) : [];
    labels.push(...relays.slice(0, obstaclesMax).map((relay) => ({ x: view.screenX(relay.x),
      y: view.screenY(relay.y), radius })));
    const placed = placeLabels(labels, this.coveredBoxes(), view.width, view.height,
      (text) => context.measureText(text).width);
    this.canvas.dataset.labels = placed.length;
    for (const { text, left, top } of placed) {
      context.strokeText(text, left, top + 1);
      context.fillText(text, left, top + 1);
    }
  }

  // A name that finds no room gives way to the serial, or to the value that is shown.
  labelOf(node) {
    const value = this.shownValue(node);
    if (value) return { text: node.name ? `${node.name}: ${value}` : value, short: node.name ? value : undefined };
    if (this.shading) return { text: node.name ?? "" };
    return { text: node.name ?? String(node.serial), short: node.name ? String(node.serial) : undefined };
  }

  // Of what lies on the map.
  coveredBoxes() {
    return [...this.canvas.parentElement.querySelectorAll(".tools, #measured, #scale")]
      .filter((part) => part.offsetWidth > 0)
      .map((part) => ({ left: part.offsetLeft, top: part.offsetTop,
        right: part.offsetLeft + part.offsetWidth, bottom: part.offsetTop + part.offsetHeight }));
  }

  // What a node measures of the quantity that is shown; "" where it is not known to.
  shownValue(node) {
    const reading = this.shading?.ofSerial.get(node.serial);
    if (!reading) return "";
    const { digits, quantity } = this.shading;
    const finer = digits === undefined ? undefined : Math.min(9, digits + 1);
    const text = (reading.disagrees ? "⚠ " : "") + valueText(reading.value, quantity.unit, finer);
    return reading.isStale ? `${text} (stale)` : text;
  }

  isSeen(point) {
    const x = this.view.screenX(point.x);
    const y = this.view.screenY(point.y);
    return x > -20 && x < this.view.width + 20 && y > -20 && y < this.view.height + 20;
  }

  // The roundest length with room for its text: at the most 160 pixels, or half of the width.
  drawScale() {
    const metres = this.mesh?.metresPerUnit;
    const step = metres || 1;   // units are round where metres are not known
    const longest = Math.min(160, this.view.width / 2) / this.view.scale * step;
    const power = 10 ** Math.floor(Math.log10(longest));
    const round = [5, 2, 1].map((digit) => digit * power).find((value) => value <= longest) ?? power;
    this.scaleBar.style.width = `${round / step * this.view.scale}px`;
    this.scaleBar.firstElementChild.textContent = lengthText(round / step, metres);
  }

  setHover(at) {
    const found = at && this.foundAt(at);
    this.canvas.classList.toggle("over", Boolean(found));
    this.tip.hidden = !found;
    if (found) {
      this.tip.textContent = this.tipText(found);
      const x = Math.min(at.x + 14, this.view.width - this.tip.offsetWidth - 4);
      this.tip.style.left = `${Math.max(4, x)}px`;
      this.tip.style.top = `${Math.max(4, at.y - 10 - this.tip.offsetHeight)}px`;
    }
    if (found === this.hover) return;
    this.hover = found;
    this.redraw();
  }

  tipText(found) {
    if (found.isItem) return itemText(this.mesh, found);
    if (!found.isNode) return `Proposed relay on feature ${featureText(found)}`;
    const value = this.shownValue(found);
    return `${nameOf(found)}, ${wordOfState(found.state)}${found.lowBattery ? ", low battery" : ""}${value ? `, ${value}` : ""}`;
  }

  // A point before a line or an area.
  foundAt(at) {
    if (!this.mesh) return null;
    const point = this.pointAt(at);
    if (point) return point;
    const { view } = this;
    const place = { x: view.worldX(at.x), y: view.worldY(at.y) };
    return itemAt(this.mesh, place, lineHitDistance / view.scale, (name) => this.isOn(name));
  }

  // The nearest point that is shown, if it is near; a node rather than a Steiner vertex.
  pointAt({ x, y }) {
    let best = null;
    let bestDistance = hitDistance;
    const look = (point, handicap) => {
      if (!point.hasPlace) return;
      const distance =
        Math.hypot(this.view.screenX(point.x) - x, this.view.screenY(point.y) - y) + handicap;
      if (distance < bestDistance) [best, bestDistance] = [point, distance];
    };
    for (const node of this.mesh.nodes) {
      if (node.state !== "waiting" && this.isOn(node.state)) look(node, 0);
    }
    if (this.isOn("steiner")) for (const point of this.mesh.steiner) look(point, 2);
    return best;
  }

  // A sample of a layer for the legend.
  drawSample(canvas, name) {
    const ratio = window.devicePixelRatio || 1;
    canvas.width = 26 * ratio;
    canvas.height = 16 * ratio;
    const context = canvas.getContext("2d");
    context.scale(ratio, ratio);
    const colour = { holes: "hole", edges: "edge", links: "link", features: "feature", gaps: "hole",
      refused: "quarantined" }[name] ?? name;
    context.strokeStyle = context.fillStyle = this.colours[colour];
    context.lineCap = "round";
    if (name === "plan") {
      context.strokeStyle = this.colours.edge;
      context.strokeRect(3.5, 2.5, 19, 11);
      context.strokeRect(7.5, 5.5, 6, 5);
    } else if (name === "holes") {
      context.globalAlpha = 0.5;
      context.beginPath();
      context.arc(13, 8, 7, 0, 2 * Math.PI);
      context.fill();
    } else if (name === "battery") {
      lowBattery(context, 13, 8, 6, this.colours);
    } else if (["edges", "links", "features", "gaps", "refused"].includes(name)) {
      context.lineWidth = { edges: 1.5, features: 3, gaps: 5 }[name] ?? 2;
      if (name === "links" || name === "refused") context.setLineDash([5, 4]);
      context.beginPath();
      context.moveTo(2, 8);
      context.lineTo(24, 8);
      context.stroke();
    } else {
      context.beginPath();
      if (name === "steiner") diamond(context, 13, 8, 5);
      else nodeShape(context, name, 13, 8, 5);
      context.lineWidth = 2;
      if (isOutline(name)) context.stroke();
      else context.fill();
    }
  }
}

// How far points are apart, about; where all stand on a line they are not that dense.
function spacingOf(mesh) {
  if (!mesh.bounds || mesh.points.size < 2) return Infinity;
  const across = mesh.bounds.right - mesh.bounds.left;
  const up = mesh.bounds.top - mesh.bounds.bottom;
  return Math.sqrt(Math.max(across * up, Math.max(across, up) ** 2 / 20) / mesh.points.size);
}
