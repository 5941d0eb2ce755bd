// SPDX-License-Identifier: MIT
// For pages with scripts: elements whose text is never markup, numbers as text, choices, and tables that sort and filter.
"use strict";
const tandem = {};
tandem.darkness = matchMedia("(prefers-color-scheme: dark)");

tandem.read = id => JSON.parse(document.getElementById("data-" + id)?.textContent ?? "null");

/** An element with attributes and children. Strings become text nodes. */
tandem.element = (name, attributes, ...children) => {
  const made = document.createElement(name);
  for (const [key, value] of Object.entries(attributes || {}))
    if (typeof value === "function") made[key] = value;
    else if (value !== null && value !== undefined) made.setAttribute(key, value);
  made.append(...children.filter(child => child !== null && child !== undefined));
  return made;
};

/** Appends children to a part of the page, and shows it and the link to it. */
tandem.show = (id, ...children) => {
  document.getElementById(id).append(...children);
  for (const hidden of document.querySelectorAll(`#${id}[hidden], nav a[href="#${id}"]`)) hidden.hidden = false;
};

/** Fills a part of the page. If that fails, the part has a message, and others are not affected. */
tandem.attempt = (id, part) => {
  try {
    part();
  } catch (error) {
    tandem.show(id, tandem.element("p", {class: "bad", role: "alert"}, "This part could not be drawn: " + error.message));
    console.error(error);
  }
};

/** A number as text with about four digits, as tables.py writes it. */
tandem.number = value => {
  if (value === null || value === undefined) return "";
  const size = Math.abs(value);
  if (size === 0) return "0";
  if (size >= 1e7 || size < 1e-4) return value.toExponential(2).replace(/\.?0+e/, "e");
  return size >= 1000 ? Math.round(value).toLocaleString("en") : String(+value.toPrecision(4));
};
tandem.count = (count, one, more) => `${count} ${count === 1 ? one : more}`;

/** A selection among options, each {value, text}. */
tandem.choice = (label, options, change) => {
  const select = tandem.element("select", {onchange: () => change(select.value)},
    ...options.map(({value, text}) => tandem.element("option", {value}, text)));
  return tandem.element("label", {class: "wide"}, label, select);
};

/** A table of texts and numbers for the numbers of a chart, like those of tables.py. */
tandem.table = (caption, heads, rows) => tandem.element("div", {class: "scrolls", tabindex: "0", role: "group", "aria-label": caption}, tandem.element("table", {},
  tandem.element("caption", {}, caption),
  tandem.element("thead", {}, tandem.element("tr", {}, ...heads.map(head => tandem.element("th", {scope: "col"}, head)))),
  tandem.element("tbody", {}, ...rows.map(row => tandem.element("tr", {}, ...row.map((value, i) => tandem.element("td", {class: typeof value === "number" ? "number" : null,
    "data-label": heads[i]}, typeof value === "number" ? tandem.number(value) : String(value ?? ""))))))));

/** Lets readers sort a table by its headings, and filter it by words and by the values of columns of class "choice". */
tandem.Sorted = class {
  constructor(table) {
    this.table = table;
    this.bodies = [...table.tBodies];
    this.heads = [...table.tHead.rows[0].cells];
    this.words = this.bodies.map(body => [...body.rows[0].cells, ...body.querySelectorAll(".words")].map(cell => cell.textContent).join(" ").toLowerCase());
    this.chosen = new Map();
    this.count = tandem.element("p", {role: "status", "aria-live": "polite"});
    const filter = tandem.element("input", {type: "search", placeholder: "k=18 tiled", oninput: () => this.filter(filter.value)});
    const choices = this.heads.flatMap((head, i) => head.classList.contains("choice") ? [this.choice(head.textContent, i)] : []);
    table.parentNode.before(tandem.element("div", {class: "controls"}, tandem.element("label", {class: "wide"}, "words of a row", filter), ...choices), this.count);
    this.heads.forEach((head, i) => {
      head.setAttribute("aria-sort", "none");
      head.replaceChildren(tandem.element("button", {type: "button", onclick: () => this.sort(head, i)}, head.textContent));
    });
    this.filter("");
  }

  text(body, i) {
    return body.rows[0].cells[i].textContent;
  }

  choice(name, i) {
    const values = [...new Set(this.bodies.map(body => this.text(body, i)))].sort();
    return tandem.choice(name, ["", ...values].map(value => ({value, text: value || "all"})), value => {
      this.chosen.set(i, value);
      this.filter(this.typed);
    });
  }

  filter(typed) {
    this.typed = typed;
    const words = typed.toLowerCase().split(/\s+/);
    this.bodies.forEach((body, row) => {
      body.hidden = !words.every(word => this.words[row].includes(word)) || [...this.chosen].some(([i, value]) => value && value !== this.text(body, i));
    });
    this.count.textContent = `${this.bodies.filter(body => !body.hidden).length} of ${tandem.count(this.bodies.length, "row", "rows")}`;
  }

  /** Numbers by value, texts alphabetically with numbers in them by value; rows without a value come last. */
  sort(head, i) {
    const direction = head.getAttribute("aria-sort") === "ascending" ? -1 : 1;
    for (const other of this.heads) other.setAttribute("aria-sort", other !== head ? "none" : direction > 0 ? "ascending" : "descending");
    const isNumber = head.classList.contains("number");
    const value = text => isNumber ? parseFloat(text.replace(/[^\d.e-]/g, "")) : text;
    const order = isNumber ? (a, b) => a - b : new Intl.Collator("en", {numeric: true}).compare;
    const keys = new Map(this.bodies.map(body => [body, value(this.text(body, i))]));
    const isMissing = key => key === "" || Number.isNaN(key);
    const sorted = [...this.bodies].sort((a, b) => {
      const [x, y] = [keys.get(a), keys.get(b)];
      return isMissing(x) || isMissing(y) ? isMissing(x) - isMissing(y) : direction * order(x, y);
    });
    this.table.append(...sorted);
  }
};

for (const table of document.querySelectorAll("table.sorts")) new tandem.Sorted(table);
