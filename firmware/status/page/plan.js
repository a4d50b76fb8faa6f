// The plan of the site, a picture that lies below the mesh.

const opacity = 0.75;
const opacityAtNight = 0.4;   // or a white sheet would outshine the mesh

export class Plan {
  // `changed` is called when the picture has come.
  constructor(changed) {
    this.changed = changed;
    this.picture = null;
    this.said = null;   // as status.json has it
  }

  // Takes over what status.json says of it; undefined where there is none.
  set(said) {
    const isSame = this.said?.version === said?.version;
    this.said = said ?? null;
    if (isSame) return;
    this.picture = null;
    if (!said) return;
    const picture = new Image();
    picture.addEventListener("load", () => {
      if (this.said?.version !== said.version) return;
      this.picture = picture;
      this.changed();
    });
    picture.src = `plan?version=${said.version}`;
  }

  draw(context, view, isNight) {
    if (!this.picture) return;
    const [left, right, below] = this.said.corners.map(([x, y]) => [view.screenX(x), view.screenY(y)]);
    const { naturalWidth: wide, naturalHeight: tall } = this.picture;
    context.save();
    context.globalAlpha = isNight ? opacityAtNight : opacity;
    context.transform((right[0] - left[0]) / wide, (right[1] - left[1]) / wide,
      (below[0] - left[0]) / tall, (below[1] - left[1]) / tall, left[0], left[1]);
    context.drawImage(this.picture, 0, 0);
    context.restore();
  }
}
