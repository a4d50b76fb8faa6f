// What every part of the page makes its elements with.

export const byId = (id) => document.getElementById(id);

export function element(tag, text, className) {
  const made = document.createElement(tag);
  if (text !== undefined) made.textContent = text;
  if (className) made.className = className;
  return made;
}

// A selection, and what a screen reader says again, outlive a text that stays the same.
export function setText(target, text) {
  if (target.textContent !== text) target.textContent = text;
}

// A text in which a path of the guide ("/guide/site.html#where-lines-meet") is a link to it.
export function linked(text) {
  return text.split(/(\/guide\/[\w.#-]+)/).map((part) => {
    if (!part.startsWith("/guide/")) return part;
    const link = element("a", part.slice(1));
    link.href = part.slice(1);
    return link;
  });
}

// Rows of a list, one for each entry. Those that `keyOf` calls the same stay: a click, the focus and a
// selection outlive what comes and goes around them.
export function showRows(list, entries, keyOf, make) {
  const before = new Map([...list.children].map((row) => [row.dataset.key, row]));
  const rows = entries.map((entry) => {
    const key = keyOf(entry);
    const row = before.get(key) ?? make(entry);
    before.delete(key);
    row.dataset.key = key;
    return row;
  });
  for (const row of before.values()) row.remove();
  rows.forEach((row, at) => {
    if (list.children[at] !== row) list.insertBefore(row, list.children[at] ?? null);
  });
}

// Says of each cell what it is, for who sees no head above it; and what it is for who hears it, whatever it
// looks like.
export function labelCells(table) {
  const heads = [...table.tHead.rows[0].cells];
  table.setAttribute("role", "table");
  for (const part of table.querySelectorAll("thead, tbody")) part.setAttribute("role", "rowgroup");
  for (const row of table.rows) row.setAttribute("role", "row");
  for (const head of heads) head.setAttribute("role", "columnheader");
  for (const body of table.tBodies) {
    for (const row of body.rows) {
      [...row.cells].forEach((cell, at) => {
        cell.setAttribute("role", "cell");
        cell.dataset.label = heads[at].textContent;
      });
    }
  }
}

// What has no focus of its own has it until somebody goes on; `seen` comes into view.
export function focusOn(part, seen = part) {
  if (!part) return;
  if (part.tabIndex < 0) part.tabIndex = -1;
  part.focus({ preventScroll: true });
  seen.scrollIntoView({ block: "nearest" });
}
