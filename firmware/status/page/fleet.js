// The gateways of the site: who is there, and whether all have the same mesh.
import { byId, element, showRows } from "./dom.js";
import { sinceText } from "./model.js";

// Names of colours (style.css); gateways beyond the last begin again.
export const memberColours = ["member-0", "member-1", "member-2", "member-3", "member-4", "member-5"];

const states = {
  here: "", gone: "gone", name_taken: "its name is taken", rejected: "rejected", waiting: "not complete yet",
  unknown: "unknown",
};

// The number of the colour of each gateway that hears nodes; our own, which is not named at its nodes,
// under "". Empty where there is but one.
export function coloursOfMembers(fleet) {
  const members = (fleet?.members ?? []).filter((member) => member.nodes > 0);
  if (members.length < 2) return new Map();
  return new Map(members.map((member, at) =>
    [member.name === fleet.name ? "" : member.name, at % memberColours.length]));
}

export function showFleet(status) {
  const { fleet } = status;
  byId("fleet").hidden = !fleet;
  if (!fleet) return;
  byId("fleet-title").textContent =
    `Fleet ${fleet.site}: ${fleet.agreeing} of ${fleet.members.length} agree`;
  showLine("apart", fleet.connected ? "" : `apart since ${sinceText(fleet.apart_ms)}` +
    (fleet.trouble ? `: ${fleet.trouble}` : ""));
  showLine("site", fleet.site_number ? `Site file of ${fleet.site_gateway}, number ${fleet.site_number}` : "");
  showLine("site-trouble", fleet.site_trouble ?? "");
  const colours = coloursOfMembers(fleet);
  const list = byId("members");
  showRows(list, fleet.members, (member) => member.name, () => element("li"));
  fleet.members.forEach((member, at) => fillMember(list.children[at], member, fleet, colours));
}

function showLine(id, text) {
  const line = byId(id);
  line.hidden = text === "";
  if (line.textContent !== text) line.textContent = text;
}

function fillMember(item, member, fleet, colours) {
  const isOwn = member.name === fleet.name;
  const colour = colours.get(isOwn ? "" : member.name);
  const name = element("b", member.name + (isOwn ? " (this one)" : ""));
  if (colour !== undefined) {
    const sample = element("span", "", "swatch");
    sample.style.background = `var(--${memberColours[colour]})`;
    name.prepend(sample);
  }
  item.replaceChildren(name, element("span", `${member.nodes} ${member.nodes === 1 ? "node" : "nodes"}`));
  if (member.version) item.append(element("span", `version ${member.version}`));
  if (member.state !== "here") {
    const since = member.since_ms === undefined ? "" : ` since ${sinceText(member.since_ms)}`;
    item.append(element("span", (states[member.state] ?? member.state) + since, "stale"));
  }
  if (member.why) item.append(element("span", member.why, "stale"));
  if (member.agrees) {
    item.append(element("span", `mesh ${member.mesh_hash.slice(0, 8)}`));
  } else if (member.state === "here") {
    item.append(element("span", member.why ? "another mesh" : "its mesh changes", "stale"));
  }
}
