// SPDX-License-Identifier: MIT
// Fills the parts of the page that scripts draw.
"use strict";
(() => {
  const records = tandem.read("records");
  const scene = tandem.read("scene");
  if (records) tandem.attempt("charts", () => tandem.charts(records));
  if (scene) tandem.attempt("view", () => tandem.view(scene));
  document.documentElement.dataset.ready = "true";
})();
