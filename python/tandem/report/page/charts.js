// SPDX-License-Identifier: MIT
// A chart of the page: a title with its result, a choice of its data, a canvas that is drawn when it comes into view, and a
// table of the same numbers.
"use strict";

/** Colours that are distinct for readers with colour blindness (Okabe and Ito 2008), on light and dark backgrounds. */
tandem.palette = dark => dark
  ? ["#e69f00", "#56b4e9", "#2bc79a", "#f0e442", "#ff7f4d", "#e59ac4", "#c9d1d9", "#8fb0ff"]
  : ["#b35c00", "#0072b2", "#007a56", "#8a7a00", "#c23b00", "#a3487a", "#444c56", "#4455c4"];
tandem.markers = ["circle", "rect", "triangle", "rectRot", "star", "crossRot", "rectRounded", "cross"];

tandem.colour = i => tandem.palette(tandem.darkness.matches)[i % 8];
tandem.ofStyle = name => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

/** Draws 95 % intervals as lines through their points: dataset.intervals has [low, high] or null for each point. */
tandem.whiskers = {
  id: "whiskers",
  afterDatasetsDraw(chart) {
    const draw = chart.ctx;
    chart.data.datasets.forEach((dataset, i) => {
      if (!dataset.intervals || !chart.isDatasetVisible(i)) return;
      const across = chart.options.indexAxis === "y";
      const scale = chart.scales[across ? "x" : "y"];
      draw.save();
      draw.strokeStyle = dataset.borderColor;
      draw.lineWidth = 2;
      chart.getDatasetMeta(i).data.forEach((point, j) => {
        if (!dataset.intervals[j]) return;
        const [low, high] = dataset.intervals[j].map(value => scale.getPixelForValue(value));
        draw.beginPath();
        if (across) { draw.moveTo(low, point.y); draw.lineTo(high, point.y); }
        else { draw.moveTo(point.x, low); draw.lineTo(point.x, high); }
        draw.stroke();
      });
      draw.restore();
    });
  }
};

/** A logarithmic axis with ticks at powers of ten, and also at their doubles and quintuples if there are few. More would overlap. */
tandem.logarithmic = (text, many) => ({type: "logarithmic", title: {display: true, text: text + ", logarithmic"}, ticks: {maxRotation: 45, autoSkip: true,
  callback: value => (many ? [1] : [1, 2, 5]).includes(+value.toExponential(3).split("e")[0]) ? tandem.number(value) : ""}});

/** An axis with a title; logarithmic if values differ by a factor above ten and none is 0. */
tandem.axis = (text, values, more) => {
  const known = values.filter(value => value !== null && value !== undefined);
  const least = Math.min(...known);
  const most = Math.max(...known);
  const log = least > 0 && most / least > 10;
  if (log) return {...tandem.logarithmic(text, most / least > 1000), ...more};
  return {type: "linear", beginAtZero: true, title: {display: true, text}, ticks: {maxRotation: 45, callback: value => tandem.number(value)}, ...more};
};

/** Maximum length of names beside bars. */
tandem.nameLength = () => innerWidth < 640 ? 22 : 38;
tandem.shortened = (text, length) => text.length > length ? text.slice(0, length - 1) + "…" : text;

tandem.Figure = class {
  /** `choices`: list of {value, text}. `describe` returns {title, alt, type, data, options, table, height} for a value. */
  constructor({id, label, choices, describe}) {
    Object.assign(this, {id, label, choices, describe, value: choices[0].value, chart: null, drawn: false});
  }

  show() {
    const {element} = tandem;
    this.title = element("h3", {id: this.id + "-title"});
    this.canvas = element("canvas", {role: "img"});
    this.plot = element("div", {class: "plot"}, this.canvas);
    this.table = element("div");
    const choice = this.choices.length > 1 ? element("div", {class: "controls"},
      tandem.choice(this.label, this.choices, value => { this.value = value; this.refresh(); })) : null;
    this.figure = element("figure", {id: this.id, "aria-labelledby": this.id + "-title"}, this.title, choice, this.plot,
      element("details", {}, element("summary", {}, "The numbers of this chart"), this.table));
    tandem.show("charts", this.figure);
    this.refresh();
    new IntersectionObserver((entries, observer) => {
      if (!entries.some(entry => entry.isIntersecting)) return;
      observer.disconnect();
      this.draw();
    }, {rootMargin: "200px"}).observe(this.figure);
    addEventListener("beforeprint", () => this.draw());
    tandem.darkness.addEventListener("change", () => this.drawn && this.draw());
  }

  refresh() {
    const what = this.describe(this.value);
    this.title.textContent = what.title;
    this.canvas.setAttribute("aria-label", `${what.title} ${what.alt} The numbers are in the table below.`);
    this.table.replaceChildren(tandem.table(...what.table));
    if (what.height) this.plot.style.height = what.height + "px";
    else this.plot.style.height = "";
    if (this.drawn) this.draw();
  }

  /** Draws the chart with the current colours of the page. */
  draw() {
    this.drawn = true;
    if (this.chart) this.chart.destroy();
    const {type, data, options} = this.describe(this.value);
    Chart.defaults.color = tandem.ofStyle("--text");
    Chart.defaults.borderColor = tandem.ofStyle("--grid");
    Chart.defaults.font.family = "system-ui, sans-serif";
    data.datasets.forEach((dataset, i) => {
      const colour = tandem.colour(dataset.colour ?? i);
      Object.assign(dataset, {borderColor: dataset.borderColor ?? colour, backgroundColor: colour, pointRadius: dataset.pointRadius ?? 5,
        pointStyle: dataset.pointStyle ?? tandem.markers[i % tandem.markers.length]});
    });
    this.chart = new Chart(this.canvas, {type, data, plugins: [tandem.whiskers],
      options: {animation: false, maintainAspectRatio: false, ...options,
        plugins: {legend: {display: data.datasets.length > 1, position: "bottom", labels: {usePointStyle: true}}, ...options.plugins}}});
    this.figure.dataset.drawn = "true";
  }
};
