// What is wrong, since when, and what to do: the worst first.
import { rankOf } from "./banner.js";
import { byId, element, linked, setText, showRows } from "./dom.js";
import { momentOf, momentText } from "./model.js";

// More are on the gateway itself, and on paper.
const shownMax = 100;
let isWhole = false;
let shown = null;   // what showAlarms() was called with

// Whether the list that is shown is an older one.
export function isOldList(status) {
  return byId("alarms").dataset.shown !== keyOf(status);
}

function keyOf(status) { return `${status.instance} ${status.alarms.edition}`; }

// `follow` is called with what an alarm is about, and what was pressed.
export function showAlarms(status, document, follow) {
  const section = byId("alarms");
  section.dataset.shown = keyOf(status);
  shown = [status, document, follow];
  const on = document.alarms.filter((alarm) => alarm.on);
  section.hidden = on.length === 0;
  on.sort((a, b) => rankOf(a) - rankOf(b) || a.since_ms - b.since_ms);
  const known = on.filter((alarm) => alarm.acknowledged).length;
  setText(byId("alarms-title"), `Alarms (${on.length})${known > 0 ? `, ${known} acknowledged` : ""}`);
  const seen = on.slice(0, isWhole ? on.length : shownMax);
  showRows(byId("alarm-list"), seen,
    ({ since_ms, ...rest }) => JSON.stringify(rest), (alarm) => row(alarm, follow));
  const more = on.length - seen.length + document.untold;
  const line = byId("alarms-more");
  line.hidden = more === 0;
  setText(line, `and ${more} more: sudo etcm-gateway ctl list`);
}

// All that are on, as paper wants them.
export function setWholeAlarms(wanted) {
  isWhole = wanted;
  if (shown) showAlarms(...shown);
}

function row(alarm, follow) {
  const item = element("li", "", alarm.severity);
  // The gateway's own commands go by the number.
  item.append(severityOf(alarm), headOf(alarm, follow), timeOf(alarm, "since"), element("span", `no. ${alarm.number}`),
    ...factsOf(alarm));
  if (alarm.cure) {
    const cure = element("p");
    cure.append(...linked(alarm.cure));
    item.append(cure);
  }
  return item;
}

// How bad it is, in a word.
export function severityOf(alarm) { return element("em", alarm.severity, "severity"); }

// Its text, which leads to what it is about.
export function headOf(alarm, follow) {
  if (!alarm.about) return element("b", alarm.text);
  const button = element("button", alarm.text);
  button.addEventListener("click", () => follow(alarm.about, button));
  return button;
}

// "since 23 Nov 2026, 14:03:10 CET"; `name` is that of a time of an alarm.
export function timeOf(alarm, name) {
  const date = momentOf(alarm, name);
  // Of an earlier run whose clock was not set.
  if (!date) return element("time", `${name} a time that is not known`);
  const time = element("time", `${name} ${momentText(date)}`);
  time.dateTime = date.toISOString();
  return time;
}

// What else is to be said of it.
export function factsOf(alarm) {
  const texts = [];
  if (alarm.times > 1) texts.push(`${alarm.times} times`);
  if (alarm.acknowledged) texts.push("acknowledged");
  return texts.map((text) => element("span", text));
}
