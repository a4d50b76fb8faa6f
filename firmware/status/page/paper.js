// The page on paper: the whole table, the map drawn anew for its size, the date and the site.
import { byId } from "./dom.js";
import { momentText } from "./model.js";
import { drawLegend } from "./panels.js";

export function preparePaper(map, table, status) {
  addEventListener("beforeprint", () => {
    document.documentElement.classList.add("paper");
    const shown = status();
    const generation = shown ? `, version (generation) ${shown.generation}` : "";
    byId("printed").textContent =
      `${document.title}, ${location.host}, ${momentText(new Date())}${generation}`;
    table.setWhole(true);
    map.setPaper(true);
    drawLegend(map);
  });
  addEventListener("afterprint", () => {
    document.documentElement.classList.remove("paper");
    table.setWhole(false);
    map.setPaper(false);
    drawLegend(map);
  });
}
