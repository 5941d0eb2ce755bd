// SPDX-License-Identifier: MIT
// The table of every cell, which can be sorted by its headings and filtered, and shows details of a cell on demand.
"use strict";

tandem.cellColumns = [
  {name: "cell", style: "name", of: cell => cell.label, shown: cell => cell.label || cell.algorithm},
  {name: "ms a frame", number: true, of: cell => cell.ms && cell.ms[0]},
  {name: "95 %", number: true, of: cell => cell.ms && (cell.ms[2] - cell.ms[1]) / 2,
   shown: cell => cell.ms && cell.rounds > 1 ? "± " + tandem.number(+((cell.ms[2] - cell.ms[1]) / 2).toPrecision(2)) : cell.ms ? tandem.oneRound : ""},
  {name: "status", of: cell => cell.status + (cell.older ? ", recorded again" : "")},
  {name: "algorithm", of: cell => cell.algorithm},
  {name: "k", number: true, of: cell => +cell.settings.k || null},
  {name: "scene", style: "wraps", of: cell => cell.scene},
  {name: "frames", style: "whole", of: cell => cell.frames},
  {name: "device", style: "wraps", of: cell => cell.device},
  {name: "launches", number: true, of: cell => cell.launches},
  {name: "waits", number: true, of: cell => cell.waits},
  {name: "candidate pairs", number: true, of: cell => cell.pairs},
  {name: "contacts", number: true, of: cell => cell.contacts}];

/** All data of a cell. */
tandem.cellDetails = (cell, data) => {
  const {element, number} = tandem;
  const facts = [["preset", cell.preset], ["driver", cell.driver], ["failure", cell.failure],
    ["time", cell.ms && `${tandem.timeText(cell)}, ${tandem.count(cell.samples, "sample", "samples")} in ` +
      tandem.count(cell.rounds, "round", "rounds")],
    ["comparison", cell.against], ["conditions", cell.conditions], ["sampling", cell.sampling],
    ["rounds", (data.rounds[cell.index] || []).map(number).join(", ") + (data.rounds[cell.index] ? " ms a frame" : "left out")],
    ["stages", Object.entries(cell.stages).map(([name, [device, host]]) => `${name} ${number(device)} (host ${number(host)})`).join(", ")],
    ["settings", Object.entries(cell.settings).map(([name, value]) => `${name}=${value}`).join(" ")],
    ["errors", cell.error && Object.entries(cell.error).map(([name, value]) => `${name.replace(/_/g, " ")} ${number(value)}`).join(", ")],
    ["scene", `${number(cell.bodies)} bodies, ${number(cell.tetrahedra)} tetrahedra`],
    ["commit", cell.commit], ["date", cell.date], ["command", cell.command],
    ["record", `${data.files[cell.file].name}, line ${cell.line}`]];
  return element("div", {class: "details"}, element("dl", {}, ...facts.filter(fact => fact[1]).flatMap(([name, value]) =>
    [element("dt", {}, name), element("dd", {}, value)])));
};

/** A row of a cell. The cell's name is a button that shows its details in a row below. */
tandem.cellRow = (cell, data) => {
  const {element} = tandem;
  const row = element("tr", {"data-cell": cell.index});
  tandem.cellColumns.forEach((column, i) => {
    const value = column.shown ? column.shown(cell) : column.of(cell);
    const text = column.number && !column.shown ? tandem.number(value) : String(value ?? "");
    const field = element("td", {class: text === tandem.oneRound ? "number long" : column.number ? "number" : column.name === "status" ? cell.status : column.style, "data-label": column.name});
    if (i > 0) field.append(...(column.style === "wraps" ? tandem.breakable(text) : [text]));
    else field.append(element("button", {type: "button", "aria-expanded": "false", onclick: event => {
      const button = event.currentTarget;
      const open = button.getAttribute("aria-expanded") === "true";
      button.setAttribute("aria-expanded", String(!open));
      if (open) row.nextSibling.remove();
      else row.after(element("tr", {class: "more"}, element("td", {colspan: tandem.cellColumns.length}, tandem.cellDetails(cell, data))));
    }}, text));
    row.append(field);
  });
  return row;
};

/** Cells sorted by a column: numbers by value, texts alphabetically with numbers in them by value. Missing values always come last. */
tandem.sorted = (cells, column, direction) => {
  const order = new Intl.Collator("en", {numeric: true}).compare;
  const missing = value => value === null || value === undefined || value === "";
  return cells.map(cell => [column.of(cell), cell]).sort(([a, x], [b, y]) => {
    if (missing(a) || missing(b)) return missing(a) - missing(b) || x.index - y.index;
    return direction * (column.number ? a - b : order(a, b)) || x.index - y.index;
  }).map(pair => pair[1]);
};

tandem.CellTable = class {
  constructor(data) {
    this.data = data;
    this.rows = new Map();
    this.filters = {text: "", scene: "", device: "", algorithm: "", status: ""};
    this.direction = 1;
    this.column = null;
    this.pending = 0;
  }

  show() {
    const {element} = tandem;
    this.count = element("p", {role: "status", "aria-live": "polite", id: "cell-count"});
    this.body = element("tbody");
    const heads = tandem.cellColumns.map(column => element("th", {scope: "col", "aria-sort": "none", class: column.number ? "number" : null},
      element("button", {type: "button", onclick: () => this.sort(column)}, column.name)));
    this.heads = heads;
    tandem.show("cells", this.controls(), this.count, element("div", {class: "tall", tabindex: "0", role: "group", "aria-labelledby": "cells-title"},
      element("table", {id: "cell-table", class: "cards"}, element("caption", {}, "A heading sorts; a cell's name shows its settings, conditions and command."),
        element("thead", {}, element("tr", {}, ...heads)), this.body)));
    this.update();
  }

  controls() {
    const {element} = tandem;
    const values = field => [...new Set(this.data.cells.map(cell => cell[field]))].sort();
    const choice = field => tandem.choice(field, [{value: "", text: "all"}, ...values(field).map(value => ({value, text: value}))],
      value => this.filter(field, value));
    const text = element("input", {type: "search", id: "cell-filter", placeholder: "k=18 tiled",
      oninput: () => this.filter("text", text.value)});
    return element("div", {class: "controls"}, element("label", {class: "wide"}, "words that a cell has", text),
      choice("scene"), choice("device"), choice("algorithm"), choice("status"));
  }

  filter(field, value) {
    this.filters[field] = value;
    this.update();
  }

  sort(column) {
    this.direction = this.column === column ? -this.direction : 1;
    this.column = column;
    this.heads.forEach((head, i) => head.setAttribute("aria-sort",
      tandem.cellColumns[i] !== column ? "none" : this.direction > 0 ? "ascending" : "descending"));
    this.update();
  }

  words(cell) {
    cell.words ??= [cell.label, cell.algorithm, cell.preset, cell.scene, cell.frames, cell.device, cell.status, cell.failure ?? "", cell.commit,
      ...Object.entries(cell.settings).map(([name, value]) => name + "=" + value)].join(" ").toLowerCase();
    return cell.words;
  }

  matching() {
    const {text, ...choices} = this.filters;
    const words = text.toLowerCase().split(/\s+/).filter(word => word);
    return this.data.cells.filter(cell => Object.entries(choices).every(([field, value]) => !value || cell[field] === value) &&
      words.every(word => this.words(cell).includes(word)));
  }

  rowOf(cell) {
    if (!this.rows.has(cell)) this.rows.set(cell, tandem.cellRow(cell, this.data));
    return this.rows.get(cell);
  }

  /** Adds the first rows at once and the rest in pieces, so that thousands of rows do not block the page. */
  update() {
    const cells = this.column ? tandem.sorted(this.matching(), this.column, this.direction) : this.matching();
    this.count.textContent = `${cells.length} of ${tandem.count(this.data.cells.length, "cell", "cells")}`;
    for (const button of this.body.querySelectorAll('[aria-expanded="true"]')) button.setAttribute("aria-expanded", "false");
    this.body.replaceChildren();
    const update = ++this.pending;
    this.body.dataset.complete = "false";
    const add = (from, to) => {
      if (update !== this.pending) return;
      this.body.append(...cells.slice(from, to).map(cell => this.rowOf(cell)));
      if (to < cells.length) setTimeout(() => add(to, 3 * to));
      else this.body.dataset.complete = "true";
    };
    add(0, 200);
  }
};
