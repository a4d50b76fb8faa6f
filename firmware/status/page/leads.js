// Where alarms lead: to a node or a feature on the map and in the details, or to the row of a unit, a bus
// or a gateway.
import { byId, focusOn } from "./dom.js";
import { featureItem } from "./items.js";

export class Leads {
  // `choose` is called with the point or item of the mesh that was found.
  constructor({ choose, buses }) {
    this.choose = choose;
    this.buses = buses;
    this.mesh = null;
    this.start = null;   // what led away
  }

  setMesh(mesh) { this.mesh = mesh; }

  // `about` as alarms have it; `start` is what was pressed.
  follow(about, start) {
    const found = this.onMap(about);
    if (found) {
      this.choose(found);
      focusOn(byId("details-title"), byId("details"));
      this.start = start;
    } else if (about.bus !== undefined) {
      this.buses.goTo(about.bus, about.unit);
    } else if (about.gateway !== undefined) {
      focusOn(rowOf("members", about.gateway));
    } else if (about.node !== undefined) {
      const unheard = rowOf("never", String(about.node));
      if (unheard) focusOn(unheard);
      else location.hash = `#node=${about.node}`;   // where it is said that nobody knows it
    }
  }

  onMap({ feature, node }) {
    if (!this.mesh) return null;
    const found = feature === undefined ? null : featureItem(this.mesh, feature);
    return found ?? this.mesh.bySerial.get(node) ?? null;
  }

  // From the details back to what led there.
  back() {
    if (this.start?.isConnected) this.start.focus();
    this.start = null;
  }
}

// A row that showRows() has made.
function rowOf(list, key) {
  return [...byId(list).children].find((row) => row.dataset.key === key);
}
