// SPDX-License-Identifier: MIT
// The scale of colours from 0 to the largest value, which the scene's data has, and its legend.
"use strict";

/** The colour of a part, from 0 to 1, of the largest value. */
tandem.scaleColour = ({colours}, part) => {
  const place = part * (colours.length - 1);
  const from = Math.min(Math.floor(place), colours.length - 2);
  return new THREE.Color(colours[from]).lerp(new THREE.Color(colours[from + 1]), place - from);
};

/** The scale with 0, the middle and the end. `text`: that of a part of the largest value. `more`: a sentence or null. */
tandem.scaleLegend = ({colours}, id, title, text, more) => {
  const {element} = tandem;
  const css = colours.map(colour => "#" + colour.toString(16).padStart(6, "0")).join(", ");
  return element("div", {class: "legend", id}, element("span", {}, title),
    element("div", {}, element("div", {class: "scale", role: "img", style: `background: linear-gradient(to right, ${css})`,
      "aria-label": `Colours from 0, dark violet, to ${text(1)}, yellow: ${title}`}),
    element("div", {class: "ends"}, ...["0", text(0.5), text(1)].map(end => element("span", {}, end)))),
    more ? element("span", {}, more) : null);
};
