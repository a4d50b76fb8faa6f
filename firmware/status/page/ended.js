// The alarms that have ended, the newest first. Asked for only while the list is open.
import { factsOf, headOf, severityOf, timeOf } from "./alarms.js";
import { byId, element, setText, showRows } from "./dom.js";
import { ageText, momentOf } from "./model.js";

// As many as the gateway tells, but where many have ended lately.
const shownMax = 100;

const section = byId("ended");
const folder = section.querySelector("details");

// Whether somebody looks at an older list.
export function isOldEnded(status) {
  return folder.open && section.dataset.shown !== keyOf(status);
}

function keyOf(status) { return `${status.instance} ${status.alarms.edition}`; }

// How many there are, which is known while nobody looks.
export function countEnded(status) {
  const { ended } = status.alarms;
  section.hidden = ended === 0;
  setText(byId("ended-title"), `Alarms that have ended (${ended})`);
}

// Takes over ended.json; `follow` as in showAlarms().
export function showEnded(status, document, follow) {
  section.dataset.shown = keyOf(status);
  const lately = document.alarms.sort((a, b) => a.until_ms - b.until_ms);
  const shown = [...lately, ...document.ended].slice(0, shownMax);
  showRows(byId("ended-list"), shown, (alarm) => `${alarm.number} ${alarm.times}`,
    (alarm) => row(alarm, follow));
  const all = status.alarms.ended;
  setText(byId("ended-bound"), shown.length < all ? `The last ${shown.length} of ${all}.` : "");
}

const ends = { by_itself: "by itself", dismissed: "dismissed", removed: "no longer known" };

// Who draws it otherwise, or takes it out, has done what its cure says.
function endOf(alarm) {
  const isOfDrawing = alarm.kind === "refused_feature" || alarm.kind === "refused_anchor";
  return isOfDrawing && ends[alarm.end] ? "cured" : ends[alarm.end];
}

function row(alarm, follow) {
  const item = element("li", "", alarm.severity);
  item.append(severityOf(alarm), headOf(alarm, follow), timeOf(alarm, "since"), timeOf(alarm, "until"));
  const isKnown = ["since", "until"].every((name) => momentOf(alarm, name));
  if (isKnown) item.append(element("span", `for ${ageText(alarm.since_ms - alarm.until_ms)}`));
  if (endOf(alarm)) item.append(element("span", endOf(alarm)));
  item.append(...factsOf(alarm));
  return item;
}
