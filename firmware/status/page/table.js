// The table of nodes: sorted, searched, and only the rows that are seen are made. A row stays the
// same element while its node is seen, and is moved only where the order changed: a click, the focus
// and a selection outlive what changes in the row.
import { byId, element, setText, showRows } from "./dom.js";
import { featureName, featuresFound } from "./features.js";
import {
  ageText, calledText, dateOf, degreesText, leftText, nameOf, nodeStates, placeText, shortMomentText, whereParts, whereText, wordOfState,
} from "./model.js";
import { conditionsOfNode, isExactly, unitIn, wordsOf } from "./units.js";

const spareRows = 8;
const featuresMax = 20;   // that a search shows

const columns = [
  { name: "serial", text: "Serial", value: (node) => node.serial },
  { name: "state", text: "State", 
    value: (node) => nodeStates.indexOf(node.state) + (node.lowBattery ? 0.5 : 0) },
  { name: "age", text: "Age", number: true, value: (node) => node.ageMs ?? Infinity },
  { name: "where", text: "Unit, bus", value: (node) => node.bus ?? "", then: (node) => node.unit },
  { name: "place", text: "Position", optional: true, value: (node) => node.x ?? Infinity,
    then: (node) => node.y },
  { name: "neighbours", text: "Neighbours", number: true, optional: true, value: (node) => node.neighbours.length },
];

export class NodeTable {
  // `chosen` is called with the node of a row, `featureChosen` with the number of a feature.
  constructor({ chosen, featureChosen }) {
    this.chosen = chosen;
    this.featureChosen = featureChosen;
    this.features = [];   // that are found
    this.area = document.getElementById("rows");
    this.body = document.getElementById("body");
    this.title = document.getElementById("nodes-title");
    this.search = document.getElementById("search");
    this.nodes = [];
    this.found = [];
    this.rows = new Map();   // of the nodes that are seen, by serial
    this.above = spacer();
    this.below = spacer();
    this.choice = null;
    this.order = { column: columns[0], isUp: true };
    this.makeHead();
    this.area.addEventListener("scroll", () => this.draw());
    this.search.addEventListener("input", () => {
      this.area.scrollTop = 0;
      this.update();
    });
    this.search.addEventListener("keydown", (event) => {
      if (event.key !== "Enter") return;
      if (this.found.length > 0) this.chosen(this.found[0]);
      else if (this.features.length > 0) this.featureChosen(this.features[0].feature);
    });
    this.body.addEventListener("click", (event) => {
      const row = event.target.closest("tr.row");
      if (row) this.chosen(this.found[Number(row.dataset.index)]);
    });
    new ResizeObserver(() => this.draw()).observe(this.area);
  }

  // Somebody looks for nodes, perhaps by what they say of themselves.
  get isSearched() { return this.search.value.trim() !== ""; }

  setNodes(nodes) {
    this.nodes = nodes;
    this.update();
  }

  // All rows are made, as paper wants them, not only those that are seen.
  setWhole(isWhole) {
    this.isWhole = isWhole;
    this.draw();
  }

  setChoice(point) {
    this.choice = point;
    this.draw();
  }

  makeHead() {
    for (const column of columns) {
      const head = document.createElement("th");
      head.scope = "col";
      head.className = classOf(column);
      const button = document.createElement("button");
      button.textContent = column.text;
      button.addEventListener("click", () => {
        this.order = { column, isUp: this.order.column !== column || !this.order.isUp };
        this.update();
      });
      head.append(button);
      column.head = head;
      document.getElementById("columns").append(head);
    }
  }

  update() {
    const words = wordsOf(this.search.value);
    this.found = this.nodes.filter((node) => words.every((word) => matches(node, word)));
    const { column, isUp } = this.order;
    const compare = (a, b) => (a < b ? -1 : a > b ? 1 : 0);
    const rank = (node) => (isExactly(words, node.serial, node.unit) ? 0 : 1);
    this.found.sort((a, b) => rank(a) - rank(b) || (isUp ? 1 : -1) *
      (compare(column.value(a), column.value(b)) ||
       (column.then ? compare(column.then(a), column.then(b)) : 0) || compare(a.serial, b.serial)));
    for (const other of columns) other.head.removeAttribute("aria-sort");
    column.head.setAttribute("aria-sort", isUp ? "ascending" : "descending");
    this.title.textContent = words.length === 0 ? `Nodes (${this.nodes.length})`
      : `Nodes (${this.found.length} of ${this.nodes.length})`;
    this.showFeatures(featuresFound(words));
    byId("no-node").hidden = words.length === 0 || this.found.length > 0 || this.features.length > 0;
    // Rows that are not made count too, for who hears the table.
    this.body.closest("table").setAttribute("aria-rowcount", this.found.length + 1);
    this.draw();
  }

  // Those that the search finds, by name or number: those of one name once, by the first of them.
  showFeatures(found) {
    const alike = (feature) => (feature.name ? found.filter((other) => other.name === feature.name) : [feature]);
    const firsts = found.filter((feature) => alike(feature)[0] === feature);
    this.features = firsts.slice(0, featuresMax);
    const list = byId("found-features");
    list.hidden = found.length === 0;
    const textOf = (feature) => {
      const more = alike(feature).length - 1;
      return `Feature ${featureName(feature)}${more > 0 ? ` and ${more} more of this name` : ""}`;
    };
    showRows(list, this.features, textOf, (feature) => {
      const item = document.createElement("li");
      const button = document.createElement("button");
      button.textContent = textOf(feature);
      button.addEventListener("click", () => this.featureChosen(feature.feature));
      item.append(button);
      return item;
    });
  }

  // With its line, as style.css has it for the room that there is.
  get rowHeight() { return parseFloat(getComputedStyle(this.area).getPropertyValue("--row")); }

  draw() {
    const { rowHeight } = this;
    const above = Math.max(0, Math.floor(this.area.scrollTop / rowHeight) - spareRows);
    const first = this.isWhole ? 0 : above;
    const shown = Math.ceil(this.area.clientHeight / rowHeight) + 2 * spareRows;
    const last = this.isWhole ? this.found.length : Math.min(this.found.length, first + shown);
    const seen = this.found.slice(first, last);
    const serials = new Set(seen.map((node) => node.serial));
    for (const [serial, row] of this.rows) {
      if (serials.has(serial)) continue;
      row.remove();
      this.rows.delete(serial);
    }
    this.place(this.above, 0);
    seen.forEach((node, at) => {
      const row = this.rows.get(node.serial) ?? this.makeRow(node.serial);
      this.fill(row, node, first + at);
      this.place(row, 1 + at);
    });
    this.place(this.below, 1 + seen.length);
    setSpace(this.above, first * rowHeight);
    setSpace(this.below, (this.found.length - last) * rowHeight);
  }

  place(row, at) {
    const there = this.body.children[at] ?? null;
    if (there === row) return;
    const focused = row.contains(document.activeElement) ? document.activeElement : null;
    this.body.insertBefore(row, there);
    focused?.focus({ preventScroll: true });
  }

  makeRow(serial) {
    const row = document.createElement("tr");
    row.dataset.serial = serial;
    for (const column of columns) {
      const cell = document.createElement("td");
      cell.className = classOf(column);
      row.append(cell);
    }
    const button = document.createElement("button");
    button.append(element("span", "", "lines"));
    row.cells[0].append(button);
    row.cells[1].append(element("span"), element("span", "", "below"), element("span", "low battery", "battery"));
    row.cells[3].append(element("span"), element("span", "", "below"));
    row.cells[4].append(element("span"), element("span", "", "below"));
    this.rows.set(serial, row);
    return row;
  }

  fill(row, node, index) {
    row.className = node === this.choice ? "row chosen" : "row";
    row.dataset.index = index;
    row.setAttribute("aria-rowindex", index + 2);
    setText(row.cells[0].firstChild.firstChild, calledText(node.serial, node.name));
    row.cells[0].title = calledText(node.serial, node.name);
    const state = row.cells[1].firstChild;
    state.className = `mark ${node.state}`;
    setText(state, wordOfState(node.state));
    setText(row.cells[1].children[1], node.leftMs === undefined ? "" : `said so ${shortMomentText(dateOf(node.leftMs))}`);
    row.cells[1].children[1].hidden = node.state !== "left";
    row.cells[1].title = leftText(node);
    row.cells[1].lastChild.hidden = !node.lowBattery;
    row.cells[1].lastChild.title = "low battery";
    setText(row.cells[2], ageText(node.ageMs));
    const [unit, bus] = whereParts(node);
    setText(row.cells[3].firstChild, unit);
    setText(row.cells[3].lastChild, bus);
    row.cells[3].title = whereText(node);
    const degrees = degreesText(node);
    setText(row.cells[4].firstChild, placeText(node));
    setText(row.cells[4].lastChild, degrees);
    row.cells[4].title = degrees ? `${placeText(node)} (${degrees})` : placeText(node);
    setText(row.cells[5], String(node.neighbours.length));
  }
}

// A number is a part of a serial or a name, or a whole unit: addresses of buses are full of numbers.
function matches(node, word) {
  if (unitIn(word) !== null) return node.unit === unitIn(word);
  if (calledText(node.serial, node.name).toLowerCase().includes(word)) return true;
  if (/^\d+$/.test(word)) return String(node.unit) === word;
  return node.state.startsWith(word) || wordOfState(node.state).includes(word) || [nameOf(node), whereText(node), ...conditionsOfNode(node)]
    .some((text) => text.toLowerCase().includes(word));
}

function classOf(column) {
  return [column.name, column.number && "number", column.optional && "optional"].filter(Boolean).join(" ");
}

// Stands for the rows that are not made.
function spacer() {
  const row = document.createElement("tr");
  row.className = "spacer";
  const cell = document.createElement("td");
  cell.colSpan = columns.length;
  row.append(cell);
  return row;
}

function setSpace(row, height) {
  row.hidden = height === 0;
  row.cells[0].style.height = `${height}px`;
}
