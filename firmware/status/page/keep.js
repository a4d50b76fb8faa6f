// What the browser keeps for who looks: what the legend shows. Where it may keep nothing, all is as ever.

const key = "etcm-legend";

export function keptLayers() {
  try {
    const kept = JSON.parse(localStorage.getItem(key));
    return kept && typeof kept === "object" ? kept : {};
  } catch {
    return {};
  }
}

export function keepLayers(layers) {
  try {
    localStorage.setItem(key, JSON.stringify(Object.fromEntries(layers.map(({ name, on }) => [name, on]))));
  } catch {
    // Private windows and full stores refuse it.
  }
}

// The serial in the address of the page, "#node=1003", or null.
export function serialInAddress() {
  const found = /^#node=(\d+)$/.exec(location.hash);
  return found ? Number(found[1]) : null;
}

export function keepInAddress(point) {
  const wanted = point?.isNode ? `#node=${point.serial}` : "";
  if (location.hash === wanted) return;
  history.replaceState(null, "", wanted || location.pathname + location.search);
}
