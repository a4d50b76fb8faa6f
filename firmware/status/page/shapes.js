// The shapes of points on the map, as parts of a path.

export function diamond(context, x, y, size) {
  context.moveTo(x, y - size);
  context.lineTo(x + size, y);
  context.lineTo(x, y + size);
  context.lineTo(x - size, y);
  context.closePath();
}

export function isOutline(state) { return state === "stale" || state === "missing" || state === "left"; }

// States differ in shape too, for who does not tell their colours apart.
export function nodeShape(context, state, x, y, radius) {
  if (state === "missing") {
    context.moveTo(x - radius, y - radius);
    context.lineTo(x + radius, y + radius);
    context.moveTo(x - radius, y + radius);
    context.lineTo(x + radius, y - radius);
  } else if (state === "left") {
    context.moveTo(x + radius, y);
    context.arc(x, y, radius, 0, 2 * Math.PI);
    context.moveTo(x - radius * 0.6, y);
    context.lineTo(x + radius * 0.6, y);
  } else if (state === "quarantined") {
    context.rect(x - radius, y - radius, 2 * radius, 2 * radius);
  } else if (state === "ageing") {
    context.moveTo(x, y - radius * 1.25);
    context.lineTo(x + radius * 1.2, y + radius * 0.9);
    context.lineTo(x - radius * 1.2, y + radius * 0.9);
    context.closePath();
  } else {
    context.moveTo(x + radius, y);
    context.arc(x, y, radius, 0, 2 * Math.PI);
  }
}

// A battery of `size` around a place, nearly empty.
export function lowBattery(context, x, y, size, colours) {
  const [wide, tall] = [size * 1.9, size * 1.1];
  context.beginPath();
  context.rect(x - wide / 2, y - tall / 2, wide, tall);
  context.rect(x + wide / 2, y - tall / 4, size / 4, tall / 2);
  context.fillStyle = colours.back;
  context.fill();
  context.strokeStyle = colours.battery;
  context.lineWidth = Math.max(1.3, size / 5);
  context.stroke();
  context.fillStyle = colours.battery;
  context.fillRect(x - wide / 2, y - tall / 2, wide * 0.3, tall);
}
