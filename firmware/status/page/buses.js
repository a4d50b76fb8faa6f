// The buses, and below each the units that are named or have ever answered: trouble first.
import { byId, element, focusOn, labelCells, setText } from "./dom.js";
import { calledText, sinceText } from "./model.js";
import {
  byUrgency, errorsText, hasGone, isExactly, isUnheard, matchesUnit, notesOf, stateText, wordsOf,
} from "./units.js";

const meterMs = 10000;   // until then nothing has been measured

const columns = ["Unit", "Node", "State", "Errors", "Answer", "Notes"];

export class BusList {
  // `go` is called with the serial of a node that was clicked.
  constructor({ go }) {
    this.go = go;
    this.units = [];
    this.rows = new Map();   // of buses, by name
    this.wanted = null;      // the unit to go to once it is there
    this.wantsFirst = false; // of those found, once they are there
    byId("unit-search").addEventListener("input", () => {
      this.wantsFirst = false;
      this.draw();
    });
    byId("unit-search").addEventListener("keydown", (event) => {
      if (event.key !== "Enter" || this.words.length === 0) return;
      this.wantsFirst = true;
      this.draw();
    });
  }

  // Whether anybody looks at units.
  get isOpen() {
    return this.words.length > 0 || [...this.rows.values()].some((row) => row.details.open);
  }

  get words() { return wordsOf(byId("unit-search").value); }

  // Opens a bus; where `unit` is an address, goes on to that unit.
  goTo(bus, unit) {
    const row = this.rows.get(bus);
    if (!row) return;
    byId("unit-search").value = "";
    row.details.open = true;
    this.wanted = unit === undefined ? null : { bus, unit };
    focusOn(row.details.querySelector("summary"), row.details);
    this.draw();
  }

  show(status) {
    byId("bus-list").hidden = status.buses.length === 0 && status.fleet !== undefined;
    const names = new Set(status.buses.map((bus) => bus.name));
    for (const [name, row] of this.rows) {
      if (names.has(name)) continue;
      row.item.remove();
      this.rows.delete(name);
    }
    for (const bus of status.buses) {
      const row = this.rows.get(bus.name) ?? this.makeRow(bus.name);
      setText(row.answering, answeringText(bus));
      row.answering.className = bus.answering === 0 || bus.silent_ms !== undefined ? "stale" : "";
      setText(row.use, useText(bus, status));
    }
  }

  makeRow(name) {
    const item = element("li");
    const details = element("details");
    const head = element("summary");
    const row = { item, details, answering: element("span"), use: element("span"),
      table: element("div", undefined, "units") };
    head.append(element("b", name), row.answering, row.use);
    row.table.tabIndex = 0;
    row.table.setAttribute("role", "region");
    row.table.setAttribute("aria-label", `Units of ${name}`);
    details.append(head, row.table);
    details.addEventListener("toggle", () => this.draw());
    item.append(details);
    byId("buses").append(item);
    this.rows.set(name, row);
    return row;
  }

  setUnits(units) {
    this.units = units;
    this.draw();
  }

  draw() {
    const { words } = this;
    let found = 0;
    for (const [name, row] of this.rows) {
      const its = this.units.filter((unit) => unit.bus === name && words.every((word) => matchesUnit(unit, word)));
      found += its.length;
      if (this.wantsFirst && its.length > 0) this.goToFirst(its);
      row.item.hidden = words.length > 0 && this.units.length > 0 && its.length === 0;
      if (words.length > 0 && its.length > 0) row.details.open = true;
      if (row.details.open) this.fill(row, its);
    }
    byId("no-unit").hidden = words.length === 0 || this.units.length === 0 || found > 0;
  }

  // To its node, or where it has none to its line.
  goToFirst(units) {
    this.wantsFirst = false;
    const [{ bus, unit, serial }] = this.sorted(units);
    if (serial === undefined) this.wanted = { bus, unit };
    else this.go(serial);
  }

  // What was asked for by its whole number first.
  sorted(units) {
    const { words } = this;
    const rank = (unit) => (isExactly(words, unit.unit, unit.serial) ? 0 : 1);
    return units.sort((a, b) => rank(a) - rank(b) || byUrgency(a, b));
  }

  // A button and its focus stay while the units are the same ones in the same order.
  fill(row, units) {
    this.sorted(units);
    const key = units.map((unit) => `${unit.unit}:${unit.serial}:${unit.name}`).join();
    if (row.shown !== key) {
      row.shown = key;
      row.table.replaceChildren(this.makeTable(units));
    }
    const lines = row.table.querySelectorAll("tbody tr");
    units.forEach((unit, at) => {
      fillUnit(lines[at], unit);
      if (unit.bus !== this.wanted?.bus || unit.unit !== this.wanted.unit) return;
      this.wanted = null;
      focusOn(lines[at]);
    });
  }

  makeTable(units) {
    const table = element("table");
    const head = element("tr");
    for (const text of columns) {
      const cell = element("th", text);
      cell.scope = "col";
      head.append(cell);
    }
    const body = element("tbody");
    body.append(...units.map((unit) => this.makeUnit(unit)));
    table.append(element("thead"), body);
    table.tHead.append(head);
    labelCells(table);
    return table;
  }

  makeUnit(unit) {
    const line = element("tr");
    for (let at = 0; at < columns.length; ++at) line.append(element("td"));
    line.cells[0].textContent = unit.unit;
    if (unit.serial !== undefined) {
      const button = element("button", calledText(unit.serial, unit.name));
      button.addEventListener("click", () => this.go(unit.serial));
      line.cells[1].append(button);
    } else if (unit.name) {
      line.cells[1].append(`'${unit.name}'`);
    }
    line.cells[2].append(element("span"));
    return line;
  }
}

function answeringText(bus) {
  const why = bus.no_link ? `: ${bus.no_link}` : "";
  if (bus.silent_ms !== undefined) return `silent since ${sinceText(bus.silent_ms, `bus ${bus.name}`)}${why}`;
  if (bus.no_link !== undefined) return `no connection${why}`;
  return `${bus.answering} of ${bus.units} units answer`;
}

function useText(bus, status) {
  const parts = [];
  if (status.uptime_ms > meterMs) parts.push(`in use ${percent(bus.utilisation)}`);
  if (bus.efficiency > 0) parts.push(`efficiency ${percent(bus.efficiency)}`);
  return parts.join(", ");
}

// A clock that was late for a moment makes no bus fuller than full.
function percent(part) { return `${Math.min(100, Math.round(part * 100))} %`; }

function fillUnit(line, unit) {
  const state = line.cells[2].firstChild;
  state.className = `mark ${isUnheard(unit) ? "waiting" : hasGone(unit) ? "left" : unit.state}`;
  setText(state, stateText(unit));
  setText(line.cells[3], errorsText(unit));
  setText(line.cells[4], unit.answer_ms === undefined ? "–" : `${unit.answer_ms} ms`);
  line.cells[4].title = unit.answer_ms === undefined ? ""
    : `mean ${unit.answer_mean_ms} ms, longest ${unit.answer_longest_ms} ms`;
  setText(line.cells[5], notesOf(unit).join(", "));
}
