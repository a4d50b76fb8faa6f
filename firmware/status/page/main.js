// Asks the gateway how things stand, and shows it.
import { MeshMap } from "./map.js";
import { readMesh, setAges } from "./model.js";
import {
  countLegend, makeLegend, showBuses, showDetails, showEvents, showMissing, showNoAnswer,
  showQuarantine, showStatus,
} from "./panels.js";
import { NodeTable } from "./table.js";

const pauseMs = 1000;
const patienceMs = 5000;

let mesh = null;
let choice = null;
let answeredAt = null;

const map = new MeshMap(document.getElementById("map"), { chosen: choose });
const table = new NodeTable({ chosen: choose });
makeLegend(map);
document.getElementById("zoom-in").addEventListener("click", () => map.view.zoomIn());
document.getElementById("zoom-out").addEventListener("click", () => map.view.zoomOut());
document.getElementById("fit").addEventListener("click", () => map.view.fit());
document.getElementById("close").addEventListener("click", () => choose(null));
addEventListener("keydown", (event) => {
  if (event.key === "Escape") choose(null);
});

function choose(point) {
  choice = point;
  map.setChoice(point);
  table.setChoice(point);
  showDetails(point, mesh, choose);
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

async function turn() {
  const status = await ask("status.json");
  if (!mesh || mesh.generation !== status.generation || mesh.instance !== status.instance) {
    const newer = readMesh(await ask("mesh.json"));
    choice = sameIn(newer, choice);
    mesh = newer;
    setAges(mesh, await ask("ages.json"), status);
    map.setMesh(mesh);
  } else {
    setAges(mesh, await ask("ages.json"), status);
  }
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
  showDetails(choice, mesh, choose);
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
