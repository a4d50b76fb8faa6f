// One quantity over the mesh: linear in each triangle of the domain whose corners all have a value
// (readings.js), in bands of colour with isolines between them. Between two sensors there is a line and no area, so
// fewer than three shade nothing.
import { bandOf, boundsOf, isFresh, valuesOn } from "./readings.js";

const rampStops = 5;   // of style.css
const sensorsMin = 3;

export class Shading {
  // `ofSerial` has the readings of the quantity.
  constructor(mesh, quantity, ofSerial) {
    this.quantity = quantity;
    this.ofSerial = ofSerial;
    const values = valuesOn(mesh, ofSerial);
    // A node that is not in the mesh counts too: it is drawn where it was last.
    const fresh = [...ofSerial.values()].filter(isFresh).map((reading) => reading.value);
    Object.assign(this, boundsOf(fresh));
    this.bandCount = Math.max(1, this.bounds.length - 1);
    this.above = this.bounds.slice(1, -1).map(() => []);   // polygons, by bound between two bands
    this.isolines = [];
    this.shaded = [];
    const sensors = mesh.nodes.filter((node) => node.in_mesh && isFresh(ofSerial.get(node.serial)));
    if (sensors.length < sensorsMin) return;
    for (const corners of trianglesOf(mesh)) this.addTriangle(corners, values);
  }

  band(value) { return bandOf(value, this.bounds); }

  addTriangle(corners, values) {
    const at = corners.map((corner) => values.get(corner.id));
    if (at.includes(undefined)) return;
    const places = corners.map((corner) => [corner.x, corner.y]);
    this.shaded.push(places);
    this.bounds.slice(1, -1).forEach((bound, level) => {
      const polygon = [];
      const line = [];
      for (let i = 0; i < 3; ++i) {
        const j = (i + 1) % 3;
        if (at[i] >= bound) polygon.push(places[i]);
        if ((at[i] >= bound) === (at[j] >= bound)) continue;
        const part = (bound - at[i]) / (at[j] - at[i]);
        const crossing = [0, 1].map((axis) => places[i][axis] + part * (places[j][axis] - places[i][axis]));
        polygon.push(crossing);
        line.push(crossing);
      }
      if (polygon.length > 2) this.above[level].push(polygon);
      if (line.length === 2) this.isolines.push(line);
    });
  }

  // `trace` makes a path of lines, `colours` are those of the bands.
  draw(context, trace, colours, lineColour) {
    // Each covers a part of those below it, so that no seam is left between them.
    [this.shaded, ...this.above].forEach((polygons, band) => {
      trace(polygons);
      context.fillStyle = context.strokeStyle = colours[band];
      context.lineWidth = 0.6;
      context.fill();
      if (band === 0) context.stroke();
    });
    trace(this.isolines);
    context.globalAlpha = 0.6;
    context.lineWidth = 1;
    context.strokeStyle = lineColour;
    context.stroke();
    context.globalAlpha = 1;
  }
}

// Each once, from its corner with the lowest id.
function* trianglesOf(mesh) {
  for (const point of mesh.points.values()) {
    const open = new Set(point.open);
    for (let i = 0; i < point.neighbours.length; ++i) {
      const left = point.neighbours[i];
      const next = point.neighbours[(i + 1) % point.neighbours.length];
      if (open.has(i) || left < point.id || next < point.id) continue;
      const corners = [point, mesh.points.get(left), mesh.points.get(next)];
      if (corners.every(Boolean)) yield corners;
    }
  }
}

// So many colours out of the stops of the ramp, "rgb(r, g, b)" each; one alone is from its middle.
// `part` of them is mixed into the colour behind.
export function bandColours(stops, count, back, part) {
  const parts = (text) => text.match(/[\d.]+/g).slice(0, 3).map(Number);
  const [ramp, behind] = [stops.map(parts), parts(back)];
  return Array.from({ length: count }, (_, band) => {
    const at = (count === 1 ? 0.5 : band / (count - 1)) * (rampStops - 1);
    const low = Math.min(Math.floor(at), rampStops - 2);
    const mixed = behind.map((other, i) => {
      const colour = ramp[low][i] + (at - low) * (ramp[low + 1][i] - ramp[low][i]);
      return Math.round(part * colour + (1 - part) * other);
    });
    return `rgb(${mixed.join(", ")})`;
  });
}

export function rampNames() { return Array.from({ length: rampStops }, (_, at) => `value-${at}`); }
