// The features of the site as a table, those that are not in the mesh first.
import { byId, element, labelCells, linked, setText } from "./dom.js";
import { featureName, lineOf, toldFeatures } from "./features.js";
import { endsText } from "./items.js";
import { lengthText } from "./model.js";

const rowsMax = 500;

let hasOpened = false;
let isWhole = false;

// All rows, as paper wants them.
export function setWholeFeatures(wanted) { isWhole = wanted; }

// `go` is called with the number of a feature that was clicked, and its button.
export function showFeatures(mesh, go) {
  const { features, key: toldKey } = toldFeatures();
  byId("features").hidden = features.length === 0;
  const out = features.filter((feature) => !feature.in_mesh);
  setText(byId("features-title"), `Features (${features.length}` +
    `${out.length > 0 ? `, ${out.length} not in the mesh` : ""})`);
  const folder = byId("features").querySelector("details");
  // Once: what somebody has folded stays so.
  if (out.length > 0 && !hasOpened) hasOpened = folder.open = true;
  const body = byId("features-body");
  const key = `${toldKey} ${mesh.instance}:${mesh.generation} ${isWhole}`;
  if (body.dataset.shown === key) return;
  body.dataset.shown = key;
  // Those that want something first.
  const all = [...out, ...features.filter((feature) => feature.in_mesh)];
  const seen = all.slice(0, isWhole ? all.length : rowsMax);
  const rows = new Map([...body.children].map((row) => [row.dataset.key, row]));
  body.replaceChildren(...seen.map((feature) => {
    const rowKey = JSON.stringify([feature, endsText(mesh, feature)]);
    const row = rows.get(rowKey) ?? makeRow(mesh, feature, go);
    row.dataset.key = rowKey;
    return row;
  }));
  labelCells(body.closest("table"));
  byId("features-more").hidden = seen.length === all.length;
  setText(byId("features-more"), `The first ${seen.length} of ${all.length}.`);
}

function makeRow(mesh, feature, go) {
  const button = element("button", featureName(feature));
  button.addEventListener("click", () => go(feature.feature, button));
  const line = lineOf(mesh, feature);
  const length = line ? lengthText(Math.hypot(line[0][0] - line[1][0], line[0][1] - line[1][1]), mesh.metresPerUnit) : "–";
  const state = element("div");
  state.append(element("span", feature.in_mesh ? "in the mesh" : feature.refused ? "refused" : "waits",
    feature.in_mesh ? "mark fresh" : feature.refused ? "mark quarantined" : "mark waiting"));
  if (!feature.in_mesh) {
    const cure = element("p", undefined, "cure");
    cure.append(...linked(feature.cure));
    state.append(element("p", feature.why), cure);
  }
  const row = element("tr");
  row.append(...[button, endsText(mesh, feature), length, state].map((content) => {
    const cell = element("td");
    cell.append(content);
    return cell;
  }));
  return row;
}
