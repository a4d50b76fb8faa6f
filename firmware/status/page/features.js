// The features of the site: which are in the mesh, and of the others why not and what to do. Knows
// nothing of the screen.
import { calledText, degreesText, placeOfEnd } from "./model.js";

const askedMs = 5000;   // at the most so often

let features = [];       // as features.json has them
let byNumber = new Map();
let toldKey = "";
let askedAt = -Infinity;

// What changes whether features are in the mesh, or why not.
function keyOf(status) { return [status.instance, status.generation, status.alarms.edition].join(" "); }

export function areOldFeatures(status) {
  if (status.features_configured === 0) return features.length > 0;
  return toldKey !== keyOf(status) && performance.now() - askedAt > askedMs;
}

// Takes over features.json.
export function setFeatures(json, status) {
  features = json.features;
  byNumber = new Map(features.map((feature) => [feature.feature, feature]));
  toldKey = keyOf(status);
  askedAt = performance.now();
}

// All of them, and what tells them from others.
export function toldFeatures() { return { features, key: toldKey }; }

export function featureOf(number) { return byNumber.get(number); }

// "7 'fence'"
export function featureName(feature) { return calledText(feature.feature, feature.name); }

// From end to end; null where an end has no place.
export function lineOf(mesh, { from, to }) {
  const line = [placeOfEnd(mesh, from), placeOfEnd(mesh, to)];
  return line.every(Boolean) ? line : null;
}

// The feature that a line of the mesh is a part of, or undefined.
export function featureAlong(mesh, [from, to]) {
  return features.find((feature) => {
    const line = feature.in_mesh ? lineOf(mesh, feature) : null;
    return line && isOn(line, from) && isOn(line, to);
  });
}

// Coordinates have four digits behind the point.
function isOn([[fromX, fromY], [toX, toY]], [x, y]) {
  const [dx, dy] = [toX - fromX, toY - fromY];
  const length = Math.hypot(dx, dy);
  if (length === 0) return false;
  const along = ((x - fromX) * dx + (y - fromY) * dy) / length;
  const beside = Math.abs((x - fromX) * dy - (y - fromY) * dx) / length;
  return beside < 1e-3 && along > -1e-3 && along < length + 1e-3;
}

// By their names and numbers; "feature 7" too.
export function featuresFound(words) {
  if (words.length === 0) return [];
  return features.filter((feature) => {
    const text = `feature ${featureName(feature)}`.toLowerCase();
    return words.every((word) => text.includes(word));
  });
}

// Where they meet, for one that another is in the way of: in the plane and in degrees.
export function meetingText(feature) {
  if (!feature?.near) return "";
  const degrees = degreesText(feature);
  return `(${feature.near.join(", ")})${degrees && `, ${degrees}`}`;
}
