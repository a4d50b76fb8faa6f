// What the map shows beside nodes, as a table: coverage holes, barrier gaps, links too long, refused
// features and proposed relays, for who does not see the map.
import { byId, element, labelCells } from "./dom.js";
import { itemFacts, itemsOf, titleOf } from "./items.js";
import { featureText, nameOf, placeText } from "./model.js";

const rowsMax = 200;
const kinds = ["refused", "hole", "gap", "link", "relay"];

// `go` is called with the item that was clicked.
export function showFound(mesh, go) {
  const all = [...kinds.flatMap((kind) => itemsOf(mesh, kind)), ...mesh.steiner];
  byId("found").hidden = all.length === 0;
  byId("found-title").textContent = `Holes, gaps, links, relays (${all.length})`;
  const body = byId("found-body");
  const key = `${mesh.instance}:${mesh.generation}`;
  if (body.dataset.shown === key) return;
  body.dataset.shown = key;
  body.replaceChildren(...all.slice(0, rowsMax).map((item) => {
    const row = element("tr");
    const button = element("button", item.isItem ? titleOf(item) : nameOf(item));
    button.addEventListener("click", () => go(item));
    const cells = [button, ...textsOf(mesh, item)];
    row.append(...cells.map((content) => {
      const cell = element("td");
      cell.append(content);
      return cell;
    }));
    return row;
  }));
  labelCells(body.closest("table"));
  byId("found-more").hidden = all.length <= rowsMax;
  byId("found-more").textContent = `The first ${rowsMax} of ${all.length}.`;
}

function textsOf(mesh, item) {
  if (!item.isItem) return [placeText(item), `on feature ${featureText(item)}`];
  return itemFacts(mesh, item).slice(0, 2).map(([name, text]) => (name === "Nearest node"
    ? `nearest node ${text}` : text));
}
