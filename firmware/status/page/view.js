// Which part of the site is on the screen: pan and zoom by mouse, wheel, touch and keyboard.

const zoomStep = 1.35;
const keyPan = 60;       // pixels
const clickSlack = 5;    // a press that moved less is a click

export class View {
  // `changed` is called when the view is another, `clicked` and `hovered` with a place on the
  // screen (hovered with null when the pointer has left).
  constructor(canvas, { changed, clicked, hovered }) {
    this.canvas = canvas;
    this.changed = () => {
      // What says that not everything is shown goes when it is.
      canvas.parentElement.classList.toggle("zoomed", !this.followsBounds);
      changed();
    };
    this.clicked = clicked;
    this.hovered = hovered;
    this.scale = 1;                 // pixels for one unit
    this.center = { x: 0, y: 0 };   // in units
    this.bounds = null;
    this.followsBounds = true;      // until somebody pans or zooms
    this.covered = 0;               // pixels on the right that a legend covers
    this.pointers = new Map();
    this.moved = 0;
    canvas.addEventListener("pointerdown", (event) => this.press(event));
    canvas.addEventListener("pointermove", (event) => this.move(event));
    canvas.addEventListener("pointerup", (event) => this.release(event, true));
    canvas.addEventListener("pointercancel", (event) => this.release(event, false));
    canvas.addEventListener("pointerleave", () => this.hovered(null));
    canvas.addEventListener("wheel", (event) => this.wheel(event), { passive: false });
    canvas.addEventListener("keydown", (event) => this.key(event));
  }

  get width() { return this.canvas.clientWidth; }
  get height() { return this.canvas.clientHeight; }

  screenX(x) { return this.width / 2 + (x - this.center.x) * this.scale; }
  screenY(y) { return this.height / 2 - (y - this.center.y) * this.scale; }
  worldX(x) { return this.center.x + (x - this.width / 2) / this.scale; }
  worldY(y) { return this.center.y - (y - this.height / 2) / this.scale; }

  // New bounds of the site; the view follows them until somebody has chosen another.
  setBounds(bounds) {
    this.bounds = bounds;
    if (this.followsBounds) this.fit();
  }

  // So much of the right is not to be used, as long as enough is left.
  setCovered(pixels) {
    const covered = pixels < this.width / 3 ? pixels : 0;
    if (covered === this.covered) return;
    this.covered = covered;
    if (this.followsBounds) this.fit();
  }

  fit() {
    this.followsBounds = true;
    if (!this.bounds) return;
    const { left, right, bottom, top } = this.bounds;
    // The buttons are at the left, and on a small screen at the top.
    const [beside, above] = this.width > 600 ? [74, 48] : [30, 74];
    const across = Math.max(right - left, 1e-3);
    const up = Math.max(top - bottom, 1e-3);
    const fitting = Math.min((this.width - this.covered - 2 * beside) / across,
      (this.height - 2 * above) / up);
    // A single node, or a canvas that has no size yet.
    this.scale = right === left && top === bottom ? 1 : Math.max(fitting, 1e-6);
    const aside = this.covered / 2 / this.scale;
    this.center = { x: (left + right) / 2 + aside, y: (bottom + top) / 2 };
    this.changed();
  }

  // By so much around a place on the screen.
  zoom(factor, x = this.width / 2, y = this.height / 2) {
    this.followsBounds = false;
    const worldX = this.worldX(x);
    const worldY = this.worldY(y);
    this.scale = Math.min(Math.max(this.scale * factor, 1e-6), 1e5);
    this.center = {
      x: worldX - (x - this.width / 2) / this.scale,
      y: worldY + (y - this.height / 2) / this.scale,
    };
    this.changed();
  }

  pan(dx, dy) {
    this.followsBounds = false;
    this.center.x -= dx / this.scale;
    this.center.y += dy / this.scale;
    this.changed();
  }

  // Makes a place visible where it is not.
  show(point) {
    const x = this.screenX(point.x);
    const y = this.screenY(point.y);
    const margin = 30;
    if (x > margin && x < this.width - margin && y > margin && y < this.height - margin) return;
    this.followsBounds = false;
    this.center = { x: point.x, y: point.y };
    this.changed();
  }

  press(event) {
    this.canvas.setPointerCapture(event.pointerId);
    this.pointers.set(event.pointerId, this.at(event));
    if (this.pointers.size === 1) this.moved = 0;
  }

  move(event) {
    const now = this.at(event);
    const before = this.pointers.get(event.pointerId);
    if (!before) return this.hovered(now);
    if (this.pointers.size === 1) {
      this.moved += Math.hypot(now.x - before.x, now.y - before.y);
      if (this.moved > clickSlack) {
        this.canvas.classList.add("dragging");
        this.hovered(null);
        this.pan(now.x - before.x, now.y - before.y);
      }
    } else {
      this.pinch(event.pointerId, before, now);
    }
    this.pointers.set(event.pointerId, now);
  }

  // One finger of two has moved, the other is the fixed point.
  pinch(id, before, now) {
    this.moved = Infinity;
    const fixed = [...this.pointers].find(([other]) => other !== id)[1];
    const distance = (a, b) => Math.hypot(a.x - b.x, a.y - b.y);
    const was = distance(before, fixed);
    if (was > 10) this.zoom(distance(now, fixed) / was, fixed.x, fixed.y);
  }

  release(event, isClick) {
    if (!this.pointers.delete(event.pointerId) || this.pointers.size > 0) return;
    this.canvas.classList.remove("dragging");
    if (isClick && this.moved <= clickSlack) this.clicked(this.at(event));
  }

  wheel(event) {
    event.preventDefault();
    const { x, y } = this.at(event);
    const lines = event.deltaMode === 1 ? 33 : 1;
    this.zoom(Math.exp(-Math.max(-300, Math.min(300, event.deltaY * lines)) * 0.002), x, y);
  }

  key(event) {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const actions = {
      ArrowLeft: () => this.pan(keyPan, 0),
      ArrowRight: () => this.pan(-keyPan, 0),
      ArrowUp: () => this.pan(0, keyPan),
      ArrowDown: () => this.pan(0, -keyPan),
      "+": () => this.zoom(zoomStep),
      "=": () => this.zoom(zoomStep),
      "-": () => this.zoom(1 / zoomStep),
      0: () => this.fit(),
      Home: () => this.fit(),
    };
    const action = actions[event.key];
    if (!action) return;
    event.preventDefault();
    action();
  }

  zoomIn() { this.zoom(zoomStep); }
  zoomOut() { this.zoom(1 / zoomStep); }

  at(event) {
    const box = this.canvas.getBoundingClientRect();
    return { x: event.clientX - box.left, y: event.clientY - box.top };
  }
}
