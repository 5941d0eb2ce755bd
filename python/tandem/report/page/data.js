// SPDX-License-Identifier: MIT
// Functions for all parts of the page: reading its data, making elements whose text is never markup, formatting numbers.
"use strict";
const tandem = {};
tandem.darkness = matchMedia("(prefers-color-scheme: dark)");

tandem.read = id => {
  const element = document.getElementById("data-" + id);
  return element ? JSON.parse(element.textContent) : null;
};

/** An element with attributes and children. Strings become text nodes. */
tandem.element = (name, attributes, ...children) => {
  const made = document.createElement(name);
  for (const [key, value] of Object.entries(attributes || {}))
    if (typeof value === "function") made[key] = value;
    else if (value === true) made.setAttribute(key, "");
    else if (value !== false && value !== null && value !== undefined) made.setAttribute(key, value);
  made.append(...children.filter(child => child !== null && child !== undefined));
  return made;
};

/** Appends children to a section and shows it. Adds a link to it at the top of the page. */
tandem.show = (id, ...children) => {
  const section = document.getElementById(id);
  section.append(...children);
  if (!section.hidden) return;
  section.hidden = false;
  const title = section.querySelector("h2").textContent;
  document.getElementById("contents").append(tandem.element("a", {href: "#" + id}, title));
};

/** A number as text with about four digits. */
tandem.number = value => {
  if (value === null || value === undefined) return "";
  const size = Math.abs(value);
  if (size === 0) return "0";
  if (size >= 1e7 || size < 1e-4) return value.toExponential(2).replace(/\.?0+e/, "e");
  return size >= 1000 ? Math.round(value).toLocaleString("en") : String(+value.toPrecision(4));
};
tandem.oneRound = "one round: no interval";
tandem.brackets = (low, high) => low === null ? "-" : `[${tandem.number(low)}, ${tandem.number(high)}]`;
/** The interval behind a ratio in a sentence; nothing where none exists. */
tandem.withInterval = (low, high) => low === null ? "" : ` ${tandem.brackets(low, high)}`;
/** The 95 % interval of a cell's time, and its time with the interval. */
tandem.intervalText = ({ms, rounds}) => rounds > 1 ? tandem.brackets(ms[1], ms[2]) : tandem.oneRound;
tandem.timeText = cell => `${tandem.number(cell.ms[0])} ms a frame ${cell.rounds > 1 ? tandem.intervalText(cell) : `(${tandem.oneRound})`}`;
tandem.count = (count, one, more) => `${count} ${count === 1 ? one : more}`;

/** A selection among options, each {value, text}. */
tandem.choice = (label, options, change) => {
  const select = tandem.element("select", {onchange: () => change(select.value)},
    ...options.map(({value, text}) => tandem.element("option", {value}, text)));
  return tandem.element("label", {class: "wide"}, label, select);
};

/** A text that may break after commas, equals signs and underscores. */
tandem.breakable = text => text.split(/(?<=[,=_:])/).flatMap((part, i) => i ? [tandem.element("wbr"), part] : [part]);

/** A table of texts and numbers with headings, also used for the numbers of charts. On a phone, each row is a card with the headings beside its values. */
tandem.table = (caption, heads, rows) => tandem.element("div", {class: "scrolls", tabindex: "0", role: "group", "aria-label": caption}, tandem.element("table", {class: "cards"},
  tandem.element("caption", {}, caption),
  tandem.element("thead", {}, tandem.element("tr", {}, ...heads.map(head => tandem.element("th", {scope: "col"}, ...tandem.breakable(head))))),
  tandem.element("tbody", {}, ...rows.map(row => tandem.element("tr", {}, ...row.map((value, i) =>
    tandem.element("td", {class: typeof value === "number" ? "number" : null, "data-label": heads[i]},
      ...(typeof value === "number" ? [tandem.number(value)] : tandem.breakable(String(value ?? ""))))))))));

/** Makes objects of cells by the names of their fields. In rows, shared values are numbers that refer to data.values. Cells of a comparison get
 * `against`, its text. */
tandem.unpack = (data, differences) => {
  const shared = new Set(data.shared);
  const older = new Set(data.older);
  data.cells = data.cells.map((row, index) => {
    const cell = {index, older: older.has(index)};
    data.fields.forEach((field, i) => {
      cell[field] = shared.has(field) && row[i] !== null ? data.values[row[i]] : row[i];
    });
    return cell;
  });
  for (const {cell, ratio, verdict} of differences?.cells ?? [])
    if (data.cells[cell]) data.cells[cell].against = (ratio ? `${tandem.number(ratio[0])}${tandem.withInterval(ratio[1], ratio[2])} times the time in ${differences.old}: ` : "") + verdict;
  data.groups.forEach((group, number) => {
    group.number = number;
    group.cells = group.cells.map(index => data.cells[index]);
    for (const cell of group.cells) cell.group = group;
  });
  return data;
};
