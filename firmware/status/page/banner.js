// How things stand, in words: the worst of the alarms that are on, since when, and how many more there
// are. Knows nothing of the screen.
import { momentOf, momentText } from "./model.js";

// The worst first.
const severities = ["critical", "major", "minor"];

export function rankOf(alarm) { return severities.indexOf(alarm.severity); }

// Of those that are on the worst, and of these the one that has been on for longest; undefined: none is.
export function worstOf({ alarms }) {
  const age = (alarm) => (momentOf(alarm, "since") === null ? -1 : alarm.since_ms);
  return alarms.filter((alarm) => alarm.on).sort((a, b) => rankOf(a) - rankOf(b) || age(b) - age(a))[0];
}

// The guide is a click away, in the alarm.
function withoutGuide(text) { return text.replace(/;? ?(how: )?\/guide\/\S+$/, ""); }

function upperCased(text) { return text && text[0].toUpperCase() + text.slice(1); }

function fleetTroubles(fleet) {
  if (!fleet.connected) return ["no connection to the fleet"];
  const troubles = fleet.site_trouble ? ["something is wrong with the site of the fleet"] : [];
  const isOdd = fleet.agreeing < fleet.members.length;
  if (isOdd) troubles.push(`${fleet.agreeing} of ${fleet.members.length} gateways agree`);
  return troubles;
}

// What is wrong and may be no alarm.
function smallTroubles(status) {
  const troubles = [];
  if (status.state.budget_hit) troubles.push("room or budget is too small");
  // Those that the mesh refuses are alarms.
  const refused = (status.quarantine ?? []).filter((entry) => entry.feature !== undefined).length;
  const quarantined = status.quarantined - refused;
  if (quarantined > 0) troubles.push(`${quarantined} in quarantine`);
  const waiting = status.features_configured - status.features_active - refused;
  if (waiting > 0) troubles.push(`${waiting} ${waiting === 1 ? "feature waits" : "features wait"} for nodes`);
  if (status.waiting_nodes > 0) troubles.push(`${status.waiting_nodes} without a fix`);
  const sensors = status.disagreeing_sensors;
  if (sensors > 0) troubles.push(`${sensors} ${sensors === 1 ? "sensor disagrees" : "sensors disagree"} with the nodes around`);
  if (status.stale_nodes > 0) troubles.push(`${status.stale_nodes} stale`);
  if (status.fleet) troubles.push(...fleetTroubles(status.fleet));
  return troubles;
}

// What to do is said where the alarms are listed.
function alarmText(alarm) {
  const since = momentOf(alarm, "since");
  return `${upperCased(alarm.severity)}: ${alarm.text}${since ? `, since ${momentText(since)}` : ""}`;
}

// A severity, "note" or "good" for colour and sign, and a line for each thing. `alarms` as alarms.json
// has them.
export function stateInWords(status, alarms) {
  const named = worstOf(alarms);
  const troubles = smallTroubles(status);
  if (status.nodes === 0 && !status.waiting_nodes) troubles.unshift("no node in the mesh");
  if (named) {
    const others = alarms.alarms.filter((alarm) => alarm.on).length - 1 + (alarms.untold ?? 0);
    if (others > 0) troubles.unshift(`and ${others} more ${others === 1 ? "alarm" : "alarms"}`);
    return [named.severity, [alarmText(named), troubles.join(", ")].filter(Boolean).join("\n")];
  }
  // For a moment, before it is an alarm.
  if (status.troubles.length > 0) {
    return ["major", [...status.troubles.map(withoutGuide), upperCased(troubles.join(", "))].filter(Boolean).join("\n")];
  }
  return troubles.length === 0 ? ["good", "All well"] : ["note", upperCased(troubles.join(", "))];
}
