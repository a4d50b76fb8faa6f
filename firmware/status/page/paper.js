// The page on paper: all rows, all that opens, the map drawn anew for its size, the date and the site.
import { setWholeAlarms } from "./alarms.js";
import { byId } from "./dom.js";
import { setWholeFeatures } from "./feature_table.js";
import { dateOf, momentText } from "./model.js";
import { drawLegend } from "./panels.js";

// `complete` shows at once what is asked for only while somebody looks.
export function preparePaper(map, table, status, complete) {
  let opened = [];   // for paper alone
  const set = (isPaper) => {
    document.documentElement.classList.toggle("paper", isPaper);
    for (const part of opened) part.open = isPaper;
    table.setWhole(isPaper);
    setWholeAlarms(isPaper);
    setWholeFeatures(isPaper);
    map.setPaper(isPaper);
    drawLegend(map);
  };
  addEventListener("beforeprint", () => {
    const shown = status();
    const generation = shown ? `, version (generation) ${shown.generation}` : "";
    byId("printed").textContent =
      `${document.title}, ${location.host}, ${momentText(dateOf(0))}${generation}`;
    opened = [...document.querySelectorAll("main details:not([open])")];
    set(true);
    complete();
  });
  addEventListener("afterprint", () => {
    set(false);
    opened = [];
  });
}
