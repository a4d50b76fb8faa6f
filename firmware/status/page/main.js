// Asks the gateway how things stand, and shows it.
import { isOldList, showAlarms } from "./alarms.js";
import { BusList } from "./buses.js";
import { showDetails } from "./details.js";
import { setText } from "./dom.js";
import { countEnded, isOldEnded, showEnded } from "./ended.js";
import { showFeatures } from "./feature_table.js";
import { areOldFeatures, setFeatures } from "./features.js";
import { coloursOfMembers, showFleet } from "./fleet.js";
import { showFound } from "./found.js";
import { featureItem, sameItem } from "./items.js";
import { keepInAddress, serialInAddress } from "./keep.js";
import { Leads } from "./leads.js";
import { MeshMap } from "./map.js";
import { dateOf, momentText, readMesh, setAges, setBatteries, setBeginnings, setClock } from "./model.js";
import {
  countLegend, makeLegend, showBands, showEvents, showMissing, showNoAnswer, showQuantities,
  showQuarantine, showStatus, showUnheard,
} from "./panels.js";
import { preparePaper } from "./paper.js";
import { readReadings } from "./readings.js";
import { Shading } from "./shading.js";
import { NodeTable } from "./table.js";
import { readUnits, setUnits } from "./units.js";

const pauseMs = 1000;
const patienceMs = 5000;
const searchedMs = 5000;   // after which units are asked for again for a search of nodes

let mesh = null;
let readings = null;
let alarms = { alarms: [] };
let status = null;   // what the gateway said last
let choice = null;
let answeredAt = null;
let unitsAt = -Infinity;   // when units were asked for
let unitsOf = null;        // the mesh whose nodes have them

const map = new MeshMap(document.getElementById("map"), { chosen: (found) => {
  choose(found);
  // On a small screen they are below the map.
  if (found) document.getElementById("details").scrollIntoView({ block: "nearest" });
} });
const table = new NodeTable({ chosen: choose, featureChosen: goToFeature });
const go = (serial) => choose(mesh.bySerial.get(serial) ?? null);
const buses = new BusList({ go });
const leads = new Leads({ choose, buses });
const follow = (about, start) => leads.follow(about, start);
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
addEventListener("hashchange", () => {
  choice = mesh?.bySerial.get(serialInAddress()) ?? null;
  show(choice);
});
preparePaper(map, table, () => status, completeForPaper);

function choose(point) {
  choice = point;
  keepInAddress(point);
  const hadFocus = document.getElementById("details").contains(document.activeElement);
  show(point);
  if (!point && hadFocus) leads.back();
}

// To the feature itself, whether it is in the mesh or not, from a button (`start`) or from the search.
function goToFeature(number, start) {
  if (start) return leads.follow({ feature: number }, start);
  const found = featureItem(mesh, number);
  if (!found) return;
  choose(found);
  document.getElementById("details").scrollIntoView({ block: "nearest" });
}

function show(point) {
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
  if (point.isItem) return sameItem(newer, point);
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

// All units are many: they are asked for where somebody looks at them, or at a node.
async function turnUnits() {
  const isOld = unitsOf !== mesh || performance.now() - unitsAt > searchedMs;
  const isSearchDue = table.isSearched && isOld;
  if (!buses.isOpen && !choice?.isNode && !isSearchDue) return;
  unitsAt = performance.now();
  takeUnits(await ask("units.json"));
}

function takeUnits(document) {
  const units = readUnits(document, status);
  buses.setUnits(units);
  setUnits(mesh, units);
  unitsOf = mesh;
}

// The browser prints what is there when its event has been handled, so this waits for the answers.
function completeForPaper() {
  if (!mesh || document.body.classList.contains("lost")) return;
  try {
    if (isOldEnded(status)) showEnded(status, askAtOnce("ended.json"), follow);
    takeUnits(askAtOnce("units.json"));
  } catch (error) {
    console.info(String(error));
  }
}

function askAtOnce(path) {
  const request = new XMLHttpRequest();
  request.open("GET", path, false);
  request.send();
  if (request.status !== 200) throw new Error(`${path}: status ${request.status}`);
  return JSON.parse(request.responseText);
}

// A node that the address names is shown as soon as it is known.
function showWanted() {
  const wanted = serialInAddress();
  const isKnown = wanted === null || mesh.bySerial.has(wanted);
  if (!choice && wanted !== null && isKnown) choose(mesh.bySerial.get(wanted));
  document.getElementById("no-wanted").hidden = isKnown;
  if (!isKnown) setText(document.getElementById("no-wanted"), `Node ${wanted} is not known here.`);
}

async function turn() {
  status = await ask("status.json");
  setClock(status);
  await turnReadings(status);
  if (!mesh || mesh.generation !== status.generation || mesh.instance !== status.instance) {
    const newer = readMesh(await ask("mesh.json"));
    choice = sameIn(newer, choice);
    mesh = newer;
    setAges(mesh, await ask("ages.json"), status);
    map.setMesh(mesh);
    leads.setMesh(mesh);
  } else {
    setAges(mesh, await ask("ages.json"), status);
  }
  shade();
  document.getElementById("empty").hidden = mesh.bounds !== null;
  if (isOldList(status)) {
    alarms = await ask("alarms.json");
    setBeginnings(alarms);
    showAlarms(status, alarms, follow);
  }
  showStatus(status, alarms);
  setBatteries(mesh, alarms);
  countEnded(status);
  if (isOldEnded(status)) showEnded(status, await ask("ended.json"), follow);
  buses.show(status);
  await turnUnits();
  showFleet(status);
  map.plan.set(status.plan);
  map.setMembers(coloursOfMembers(status.fleet));
  showEvents(status);
  showMissing(status.missing, go);
  showQuarantine(status.quarantine, mesh, go);
  showUnheard(status.unheard);
  if (areOldFeatures(status)) setFeatures(await ask("features.json"), status);
  showFeatures(mesh, goToFeature);
  showFound(mesh, choose);
  countLegend(mesh, status);
  table.setNodes(mesh.nodes);
  table.setChoice(choice);
  map.choice = choice;
  map.redraw();
  showWanted();
  showDetails(choice, mesh, readings, choose);
}

function setLost(isLost) {
  const lost = document.getElementById("lost");
  document.body.classList.toggle("lost", isLost);
  lost.hidden = !isLost;
  if (!isLost) return;
  showNoAnswer();
  const text = answeredAt
    ? `The gateway has not answered since ${momentText(answeredAt)}. What you see is from then.`
    : "The gateway does not answer. Is it running?";
  if (lost.textContent !== text) lost.textContent = text;
}

async function run() {
  for (;;) {
    // What nobody sees is not asked for.
    if (!document.hidden) {
      try {
        await turn();
        answeredAt = dateOf(0);
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
