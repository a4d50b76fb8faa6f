// Asks the gateway how things stand, and shows it.
import { MeshMap } from "./map.js";
import { readMesh, setAges } from "./model.js";
import {
  countLegend, makeLegend, showBands, showBuses, showDetails, showEvents, showMissing, showNoAnswer,
  showQuantities, showQuarantine, showStatus,
} from "./panels.js";
import { readReadings } from "./readings.js";
import { Shading } from "./shading.js";
import { NodeTable } from "./table.js";

const pauseMs = 1000;
const patienceMs = 5000;

let mesh = null;
let readings = null;
let choice = null;
let answeredAt = null;

const map = new MeshMap(document.getElementById("map"), { chosen: choose });
const table = new NodeTable({ chosen: choose });
makeLegend(map);
document.getElementById("zoom-in").addEventListener("click", () => map.view.zoomIn());
document.getElementById("zoom-out").addEventListener("click", () => map.view.zoomOut());
document.getElementById("fit").addEventListener("click", () => map.view.fit());
const quantity = document.getElementById("quantity");
quantity.addEventListener("change", shade);
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => showBands(map, readings));
document.getElementById("close").addEventListener("click", () => choose(null));
addEventListener("keydown", (event) => {
  if (event.key === "Escape") choose(null);
});

function choose(point) {
  choice = point;
  map.setChoice(point);
  table.setChoice(point);
  showDetails(point, mesh, readings, choose);
}

// Shows the chosen quantity over the mesh, or none.
function shade() {
  const index = quantity.value === "" ? -1 : Number(quantity.value);
  const chosen = readings?.quantities[index];
  map.setShading(mesh && chosen ? new Shading(mesh, chosen, readings.ofQuantity[index]) : null);
  showBands(map, readings);
}

// The same node or Steiner vertex in a newer mesh, or null.
function sameIn(newer, point) {
  if (!point) return null;
  if (point.isNode) return newer.bySerial.get(point.serial) ?? null;
  const other = newer.points.get(point.id);
  return other && !other.isNode ? other : null;
}

async function ask(path) {
  const answer = await fetch(path, { cache: "no-cache", signal: AbortSignal.timeout(patienceMs) });
  if (!answer.ok) throw new Error(`${path}: status ${answer.status}`);
  return answer.json();
}

// Values change far more often than the mesh. Nobody looks at them where nothing shows them.
async function turnReadings(status) {
  const isSame = readings?.instance === status.instance;
  if (isSame && quantity.value === "" && !choice) return;
  readings = status.quantities === 0 ? null : readReadings(await ask("readings.json"));
  showQuantities(readings);
}

async function turn() {
  const status = await ask("status.json");
  await turnReadings(status);
  if (!mesh || mesh.generation !== status.generation || mesh.instance !== status.instance) {
    const newer = readMesh(await ask("mesh.json"));
    choice = sameIn(newer, choice);
    mesh = newer;
    setAges(mesh, await ask("ages.json"), status);
    map.setMesh(mesh);
  } else {
    setAges(mesh, await ask("ages.json"), status);
  }
  shade();
  document.getElementById("empty").hidden = mesh.bounds !== null;
  showStatus(status);
  showBuses(status);
  showEvents(status);
  const go = (serial) => choose(mesh.bySerial.get(serial) ?? null);
  showMissing(status.missing, go);
  showQuarantine(status.quarantine, go);
  countLegend(mesh);
  table.setNodes(mesh.nodes);
  table.setChoice(choice);
  map.choice = choice;
  map.redraw();
  showDetails(choice, mesh, readings, choose);
}

function setLost(isLost) {
  const lost = document.getElementById("lost");
  document.body.classList.toggle("lost", isLost);
  lost.hidden = !isLost;
  if (!isLost) return;
  showNoAnswer();
  const text = answeredAt
    ? `The gateway has not answered since ${answeredAt.toLocaleTimeString()}. What you see is from then.`
    : "The gateway does not answer. Is it running?";
  if (lost.textContent !== text) lost.textContent = text;
}

async function run() {
  for (;;) {
    // What nobody sees is not asked for.
    if (!document.hidden) {
      try {
        await turn();
        answeredAt = new Date();
        setLost(false);
      } catch (error) {
        console.info(String(error));
        setLost(true);
      }
    }
    await new Promise((done) => setTimeout(done, pauseMs));
  }
}

run();
