// SPDX-License-Identifier: MIT
// Builds the page from its parts. A part that fails shows an error message; the other parts are not affected.
"use strict";
(() => {
  const records = tandem.read("records");
  const scene = tandem.read("scene");
  const attempt = (id, part) => {
    try {
      part();
    } catch (error) {
      tandem.show(id, tandem.element("p", {class: "bad", role: "alert"}, "This part could not be drawn: " + error.message));
      console.error(error);
    }
  };
  if (records) {
    const differences = tandem.read("differences");
    tandem.unpack(records, differences);
    document.getElementById("made").textContent = "Files: " + records.files.map(file => file.name).join(", ") + (differences ? ", against " + differences.old : "") + ". Made " + records.date + ".";
    document.getElementById("program").textContent = records.program;
    attempt("summary", () => tandem.summary(records, differences));
    attempt("charts", () => tandem.charts(records, differences));
    if (records.cells.length) attempt("cells", () => new tandem.CellTable(records).show());
    attempt("others", () => tandem.ceilings(records));
  }
  if (scene) attempt("view", () => tandem.view(scene));
  document.documentElement.dataset.ready = "true";
})();
