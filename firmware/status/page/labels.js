// Where the names of points stand on the map: none over another, over a point or over what lies on the
// map, and none cut off. Knows nothing of the mesh.

const height = 14;   // of a text of 12 pixels
const gap = 2;

// `labels` have `x`, `y`, `radius`, `text`, and may have a `short` text, the important first; `covered` are boxes that are taken
// already; `widthOf` measures a text. Returns those that have room, with `left` and `top`.
export function placeLabels(labels, covered, width, tall, widthOf) {
  const taken = [...covered, ...labels.map(({ x, y, radius }) =>
    ({ left: x - radius, top: y - radius, right: x + radius, bottom: y + radius }))];
  const placed = [];
  for (const label of labels) {
    for (const text of [label.text, label.short]) {
      const box = text && boxesAround(label, widthOf(text)).find((other) => other.left >= gap &&
        other.top >= gap && other.right <= width - gap && other.bottom <= tall - gap &&
        !taken.some((one) => overlap(one, other)));
      if (!box) continue;
      taken.push(box);
      placed.push({ ...box, text });
      break;
    }
  }
  return placed;
}

function boxesAround({ x, y, radius }, wide) {
  const [right, left] = [x + radius + gap, x - radius - gap - wide];
  const [above, below] = [y - radius - height, y + radius];
  return [[right, above], [right, below], [left, above], [left, below],
    [x - wide / 2, above - gap], [x - wide / 2, below + gap]]
    .map(([at, top]) => ({ left: at, top, right: at + wide, bottom: top + height }));
}

function overlap(a, b) {
  return a.left < b.right && b.left < a.right && a.top < b.bottom && b.top < a.bottom;
}
