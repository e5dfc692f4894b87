"use strict";
// Tables sort by a click on a head, and filter by what is typed; marks tell their figures when pointed at or focused, and what
// belongs to the same method lights up everywhere. Without this script the page reads the same.

// Sorting: numbers by data-v, text as shown; what has no value stays last.
for (const table of document.querySelectorAll("table.sortable")) {
  const body = table.tBodies[0];
  const heads = [...table.tHead.rows[0].cells];
  heads.forEach((head, column) => {
    head.querySelector("button").addEventListener("click", () => {
      const down = head.getAttribute("aria-sort") === "ascending";
      for (const other of heads) other.setAttribute("aria-sort", "none");
      head.setAttribute("aria-sort", down ? "descending" : "ascending");
      const number = head.dataset.sort === "number";
      const value = (row) => {
        const cell = row.cells[column];
        if (!number) return cell.textContent.trim() || null;
        return cell.dataset.v === undefined ? null : Number(cell.dataset.v);
      };
      const compare = (a, b) =>
        number ? a - b : a.localeCompare(b, "en", { numeric: true });
      const rows = [...body.rows].map((row) => [value(row), row]);
      rows.sort(([a], [b]) => {
        if (a === null || b === null) return (a === null) - (b === null);
        return down ? compare(b, a) : compare(a, b);
      });
      for (const row of body.rows) row.classList.remove("start"); // of a view: no longer so
      body.append(...rows.map(([, row]) => row));
    });
  });
}

// Filtering: rows that have every word that is typed; those of a mark too.
for (const box of document.querySelectorAll("input.filter")) {
  const rows = [...document.getElementById(box.dataset.for).tBodies[0].rows];
  const shown = box.parentElement.querySelector("output");
  const filter = () => {
    const words = box.value.toLowerCase().split(/\s+/).filter(Boolean);
    let count = 0;
    for (const row of rows) {
      const text = row.textContent.toLowerCase();
      row.hidden = !words.every((word) => text.includes(word));
      count += !row.hidden;
    }
    shown.textContent = `${count} of ${rows.length}`;
  };
  box.addEventListener("input", filter);
  filter();
}

// Tooltips: the text of <title>, at once and in the page's own style.
const tip = document.createElement("div");
tip.className = "tip";
tip.setAttribute("aria-hidden", "true");
tip.hidden = true;
document.body.append(tip);

function show(mark) {
  const [name, ...lines] = mark.dataset.tip.split("\n");
  const bold = document.createElement("b");
  bold.textContent = name;
  tip.replaceChildren(bold, ...lines.flatMap((line) => [document.createElement("br"), line]));
  tip.hidden = false;
  const box = mark.querySelector(".hit").getBoundingClientRect();
  const middle = box.left + box.width / 2 - tip.offsetWidth / 2;
  const most = document.documentElement.clientWidth - tip.offsetWidth - 6;
  const above = box.top - tip.offsetHeight - 4;
  tip.style.left = `${Math.max(6, Math.min(middle, most)) + scrollX}px`;
  tip.style.top = `${(above > 0 ? above : box.bottom + 4) + scrollY}px`;
}

for (const mark of document.querySelectorAll(".spot")) {
  const title = mark.querySelector("title");
  mark.dataset.tip = title.textContent;
  mark.setAttribute("aria-label", title.textContent);
  title.remove();
  for (const event of ["pointerenter", "focus"]) mark.addEventListener(event, () => show(mark));
  for (const event of ["pointerleave", "blur"]) {
    mark.addEventListener(event, () => { tip.hidden = true; });
  }
}

// Linked highlighting.
const linked = [...document.querySelectorAll("[data-method]")];
function light(method) {
  document.body.classList.toggle("lit", method !== null);
  for (const one of linked) one.classList.toggle("on", one.dataset.method === method);
}
for (const one of linked) {
  one.addEventListener("pointerenter", () => light(one.dataset.method));
  one.addEventListener("pointerleave", () => light(null));
  one.addEventListener("focus", () => light(one.dataset.method));
  one.addEventListener("blur", () => light(null));
}

// The command line to the clipboard; where that is not allowed (file:), it is selected.
const copy = document.getElementById("copy");
copy?.addEventListener("click", async () => {
  const code = copy.parentElement.querySelector("code");
  try {
    await navigator.clipboard.writeText(code.textContent);
    copy.textContent = "Copied";
  } catch {
    getSelection().selectAllChildren(code);
    copy.textContent = "Selected";
  }
  setTimeout(() => { copy.textContent = "Copy"; }, 1500);
});
