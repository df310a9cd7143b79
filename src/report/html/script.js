"use strict";
for (const table of document.querySelectorAll("table.sortable")) {
  const heads = [...table.tHead.rows[0].cells];
  heads.forEach((head, column) => head.querySelector("button").addEventListener("click", () => {
    const ascending = head.getAttribute("aria-sort") !== "ascending";
    heads.forEach((other) => other.removeAttribute("aria-sort"));
    head.setAttribute("aria-sort", ascending ? "ascending" : "descending");
    const key = (row) => {
      const cell = row.cells[column];
      const text = cell.dataset.value ?? cell.textContent;
      const number = parseFloat(text);
      return head.classList.contains("number") ? (Number.isNaN(number) ? -Infinity : number) : text;
    };
    const order = (a, b) => (a < b ? -1 : a > b ? 1 : 0) * (ascending ? 1 : -1);
    const rows = [...table.tBodies[0].rows].map((row) => [key(row), row]);
    rows.sort((a, b) => order(a[0], b[0])).forEach(([, row]) => table.tBodies[0].append(row));
  }));
}
for (const divided of document.querySelectorAll(".divided")) {
  const divider = divided.querySelector("input");
  divider.addEventListener("input", () => divided.style.setProperty("--at", divider.value + "%"));
}
for (const button of document.querySelectorAll("button.copy")) {
  button.addEventListener("click", async () => {
    const text = button.parentElement.querySelector("code").textContent;
    try {
      await navigator.clipboard.writeText(text);
      button.textContent = "Copied";
    } catch {
      getSelection().selectAllChildren(button.parentElement.querySelector("code"));
    }
  });
}
