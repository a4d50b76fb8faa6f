// The table of nodes: sorted, searched, and only the rows that are seen are made.
import { ageText, nodeStates, placeText, whereText } from "./model.js";

const rowHeight = 31;   // of style.css, with its line
const spareRows = 8;

const columns = [
  { name: "serial", text: "Serial", value: (node) => node.serial },
  { name: "state", text: "State", value: (node) => nodeStates.indexOf(node.state) },
  { name: "age", text: "Age", number: true, value: (node) => node.ageMs ?? Infinity },
  { name: "where", text: "Unit, bus", isLong: true, value: (node) => node.bus ?? "", then: (node) => node.unit },
  { name: "place", text: "Place", optional: true, value: (node) => node.x ?? Infinity,
    then: (node) => node.y },
  { name: "degree", text: "Degree", number: true, value: (node) => node.degree },
];

export class NodeTable {
  // `chosen` is called with the node of a row.
  constructor({ chosen }) {
    this.chosen = chosen;
    this.area = document.getElementById("rows");
    this.body = document.getElementById("body");
    this.title = document.getElementById("nodes-title");
    this.search = document.getElementById("search");
    this.nodes = [];
    this.found = [];
    this.choice = null;
    this.order = { column: columns[0], isUp: true };
    this.makeHead();
    this.area.addEventListener("scroll", () => this.draw());
    this.search.addEventListener("input", () => {
      this.area.scrollTop = 0;
      this.update();
    });
    this.body.addEventListener("click", (event) => {
      const row = event.target.closest("tr.row");
      if (row) this.chosen(this.found[Number(row.dataset.index)]);
    });
    new ResizeObserver(() => this.draw()).observe(this.area);
  }

  setNodes(nodes) {
    this.nodes = nodes;
    this.update();
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
    const words = this.search.value.toLowerCase().split(/\s+/).filter(Boolean);
    this.found = this.nodes.filter((node) => words.every((word) => matches(node, word)));
    const { column, isUp } = this.order;
    const compare = (a, b) => (a < b ? -1 : a > b ? 1 : 0);
    this.found.sort((a, b) => (isUp ? 1 : -1) *
      (compare(column.value(a), column.value(b)) ||
       (column.then ? compare(column.then(a), column.then(b)) : 0) || compare(a.serial, b.serial)));
    for (const other of columns) other.head.removeAttribute("aria-sort");
    column.head.setAttribute("aria-sort", isUp ? "ascending" : "descending");
    this.title.textContent = words.length === 0 ? `Nodes (${this.nodes.length})`
      : `Nodes (${this.found.length} of ${this.nodes.length})`;
    this.draw();
  }

  draw() {
    const first = Math.max(0, Math.floor(this.area.scrollTop / rowHeight) - spareRows);
    const shown = Math.ceil(this.area.clientHeight / rowHeight) + 2 * spareRows;
    const last = Math.min(this.found.length, first + shown);
    // A row that has the focus keeps it.
    const focused = document.activeElement?.closest?.("tr.row")?.dataset.serial;
    const rows = [];
    if (first > 0) rows.push(spacer(first));
    for (let index = first; index < last; ++index) rows.push(this.rowOf(this.found[index], index));
    if (last < this.found.length) rows.push(spacer(this.found.length - last));
    this.body.replaceChildren(...rows);
    if (focused) this.body.querySelector(`tr[data-serial="${focused}"] button`)?.focus();
  }

  rowOf(node, index) {
    const row = document.createElement("tr");
    row.className = node === this.choice ? "row chosen" : "row";
    row.dataset.index = index;
    row.dataset.serial = node.serial;
    const serial = document.createElement("button");
    serial.textContent = node.serial;
    const state = document.createElement("span");
    state.className = `mark ${node.state}`;
    state.textContent = node.state;
    const cells = [serial, state, ageText(node.ageMs), whereText(node),
      placeText(node), String(node.degree)];
    cells.forEach((content, at) => {
      const cell = document.createElement("td");
      cell.className = classOf(columns[at]);
      cell.append(content);
      row.append(cell);
    });
    return row;
  }
}

// A number is looked for in serials alone: units and addresses are full of them.
function matches(node, word) {
  if (/^\d+$/.test(word)) return String(node.serial).includes(word);
  return node.state.startsWith(word) || whereText(node).toLowerCase().includes(word);
}

function classOf(column) {
  return [column.number && "number", column.optional && "optional", column.isLong && "long"].filter(Boolean).join(" ");
}

function spacer(rows) {
  const row = document.createElement("tr");
  row.className = "spacer";
  const cell = document.createElement("td");
  cell.colSpan = columns.length;
  cell.style.height = `${rows * rowHeight}px`;
  row.append(cell);
  return row;
}
