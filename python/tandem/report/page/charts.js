// SPDX-License-Identifier: MIT
// A chart of the page: a title with its result, a choice of its data, a canvas, and a table of the same numbers.
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

/** Where the interval of a point begins and ends, if it lies on the axis of x. */
tandem.endsAcross = (chart, dataset, j) => chart.options.indexAxis === "y" ? dataset.intervals?.[j]?.map(value => chart.scales.x.getPixelForValue(value)) : null;

/** Crosses out points: dataset.crossed tells which. */
tandem.crosses = {
  id: "crosses",
  afterDatasetsDraw(chart) {
    const draw = chart.ctx;
    draw.save();
    draw.strokeStyle = tandem.ofStyle("--bad");
    draw.lineWidth = 3;
    chart.data.datasets.forEach((dataset, i) => {
      if (!dataset.crossed || !chart.isDatasetVisible(i)) return;
      chart.getDatasetMeta(i).data.forEach(({x, y}, j) => {
        if (!dataset.crossed[j] || Number.isNaN(x)) return;
        draw.beginPath();
        for (const side of [-1, 1]) { draw.moveTo(x - 9, y - 9 * side); draw.lineTo(x + 9, y + 9 * side); }
        draw.stroke();
      });
    });
    draw.restore();
  }
};

/** Draws names beside points where there is space, on the left first if dataset.namesLeft: dataset.names has a text for each point, or nothing.
 * Names of earlier datasets come first. */
tandem.pointNames = {
  id: "pointNames",
  afterDatasetsDraw(chart) {
    const draw = chart.ctx;
    const {left, right, top, bottom} = chart.chartArea;
    const taken = [];
    const isFree = box => box[0] >= left && box[2] <= right && box[1] >= top && box[3] <= bottom &&
      !taken.some(other => box[0] < other[2] && other[0] < box[2] && box[1] < other[3] && other[1] < box[3]);
    const points = chart.data.datasets.flatMap((dataset, i) => dataset.names && chart.isDatasetVisible(i)
      ? chart.getDatasetMeta(i).data.map(({x, y}, j) => ({x, y, ends: tandem.endsAcross(chart, dataset, j) ?? [x, x], name: dataset.names[j], left: dataset.namesLeft})) : []);
    chart.namesDrawn = [];
    if (!points.length) return;
    draw.save();
    draw.font = "12px system-ui, sans-serif";
    draw.fillStyle = tandem.ofStyle("--text");
    draw.textBaseline = "middle";
    taken.push(...points.map(({x, y}) => [x - 4, y - 4, x + 4, y + 4]));
    for (const {x, y, ends, name, left: isLeft} of points.filter(point => point.name)) {
      const width = draw.measureText(name).width;
      const sides = [[ends[1] + 9, y], [ends[0] - 9 - width, y]];
      const boxes = [...isLeft ? sides.reverse() : sides, [x - width / 2, y - 16], [x - width / 2, y + 16]].map(([from, middle]) => [from, middle - 7, from + width, middle + 7]);
      const box = boxes.find(isFree);
      if (!box) continue;
      taken.push(box);
      draw.fillText(name, box[0], (box[1] + box[3]) / 2);
      chart.namesDrawn.push(name);
    }
    draw.restore();
  }
};

tandem.oneRound = "one round: no interval";
tandem.fewRounds = "fewer than 5 rounds: no interval"; // of a ratio: ROUNDS in verdicts.py
tandem.brackets = (low, high) => low === null ? "-" : `[${tandem.number(low)}, ${tandem.number(high)}]`;
/** The 95 % interval of a cell's time, and its time with the interval. */
tandem.intervalText = ({ms, rounds}) => rounds > 1 ? tandem.brackets(ms[1], ms[2]) : tandem.oneRound;
tandem.timeText = cell => `${tandem.number(cell.ms[0])} ms per frame ${cell.rounds > 1 ? tandem.intervalText(cell) : `(${tandem.oneRound})`}`;

/** The text of a point under the pointer: dataset.texts has it where positions are not the values. */
tandem.pointText = {title: items => items.some(item => item.dataset.texts) ? "" : items[0]?.label,
  label: item => item.dataset.texts?.[item.dataIndex] ?? `${item.dataset.label}: ${item.formattedValue}`};

/** Maximum length of names beside bars. */
tandem.nameLength = () => innerWidth < 640 ? 22 : 38;
tandem.shortened = (text, length) => text.length > length ? text.slice(0, length - 1) + "…" : text;

tandem.Figure = class {
  /** `part`: the part of the page. `choices`: list of {value, text}. `describe` returns {title, alt, type, data, options, table} for a value, and optionally height and notes: [{text, bad}]. */
  constructor({part = "charts", id, label = "", choices = [{value: 0, text: ""}], describe}) {
    Object.assign(this, {part, id, label, choices, describe, value: choices[0].value});
  }

  show() {
    const {element} = tandem;
    this.title = element("h3", {id: this.id + "-title"});
    this.canvas = element("canvas", {role: "img"});
    this.plot = element("div", {class: "plot"}, this.canvas);
    this.table = element("div");
    this.notes = element("div");
    const choice = this.choices.length > 1 ? element("div", {class: "controls"},
      tandem.choice(this.label, this.choices, value => { this.value = value; this.refresh(); })) : null;
    this.figure = element("figure", {id: this.id, "aria-labelledby": this.id + "-title"}, this.title, choice, this.notes, this.plot,
      element("details", {}, element("summary", {}, "The numbers of this chart"), this.table));
    tandem.show(this.part, this.figure);
    this.refresh();
    tandem.darkness.addEventListener("change", () => this.draw());
  }

  refresh() {
    const what = this.describe(this.value);
    this.title.textContent = what.title;
    this.canvas.setAttribute("aria-label", `${what.title} ${what.alt} The numbers are in the table below.`);
    this.notes.replaceChildren(...(what.notes ?? []).map(({text, bad}) => tandem.element("p", {class: bad ? "bad" : "quiet"}, text)));
    this.table.replaceChildren(tandem.table(...what.table));
    this.plot.style.height = what.height ? what.height + "px" : "";
    this.draw();
  }

  /** Draws the chart with the current colours of the page. */
  draw() {
    this.chart?.destroy();
    const {type, data, options} = this.describe(this.value);
    Chart.defaults.color = tandem.ofStyle("--text");
    Chart.defaults.borderColor = tandem.ofStyle("--grid");
    Chart.defaults.font.family = "system-ui, sans-serif";
    data.datasets.forEach((dataset, i) => {
      const colour = tandem.colour(dataset.colour ?? i);
      Object.assign(dataset, {borderColor: dataset.borderColor ?? colour, backgroundColor: dataset.backgroundColor ?? colour, pointRadius: dataset.pointRadius ?? 5,
        pointStyle: dataset.pointStyle ?? tandem.markers[i % tandem.markers.length]});
    });
    this.chart = new Chart(this.canvas, {type, data, plugins: [tandem.whiskers, tandem.crosses, tandem.pointNames],
      options: {animation: false, maintainAspectRatio: false, ...options,
        plugins: {legend: {display: data.datasets.length > 1, position: "bottom", labels: {usePointStyle: true}}, tooltip: {callbacks: tandem.pointText}}}});
  }
};
