// SPDX-License-Identifier: MIT
// Axes of charts. A logarithmic axis may have 0, at a place of its own.
"use strict";

tandem.superscripts = "⁰¹²³⁴⁵⁶⁷⁸⁹";

/** A power of ten as a decimal number, or as 10 with an exponent where that is shorter. */
tandem.powerText = exponent => {
  if (exponent >= -3 && exponent <= 4) return tandem.number(10 ** exponent);
  return "10" + (exponent < 0 ? "⁻" : "") + [...String(Math.abs(exponent))].map(digit => tandem.superscripts[+digit]).join("");
};

/** Powers of ten that enclose positions `least` to `most`, which are decimal logarithms: at most `count`, evenly spaced. */
tandem.powers = (least, most, count) => {
  const from = Math.floor(least + 1e-9);
  const to = Math.ceil(most - 1e-9);
  const step = Math.max(1, Math.ceil((to - from) / count));
  return Array.from({length: Math.floor((to - from) / step) + 1}, (_, i) => from + i * step);
};

/** Those marks {value, text}, given in order, that are at least `least` apart. */
tandem.apart = (marks, least) => marks.reduce((kept, mark) =>
  kept.length && mark.value - kept[kept.length - 1].value < least ? kept : [...kept, mark], []);

/** A logarithmic axis: {place, axis}. `place` gives the position of a value for the chart's data. Ticks are at the values themselves if `own`,
 * otherwise at powers of ten. If a value is 0, it has a tick of its own before the least positive value. No value may be negative. */
tandem.logScale = (text, values, own) => {
  const positive = [...new Set(values.filter(value => value > 0))].sort((a, b) => a - b);
  const ends = positive.length ? [Math.log10(positive[0]), Math.log10(positive[positive.length - 1])] : [0, 0];
  const powers = own ? [] : tandem.powers(...ends, innerWidth < 640 ? 5 : 10);
  const least = own ? ends[0] : powers[0];
  const most = own ? ends[1] : Math.max(powers[powers.length - 1], ends[1]);
  const gap = Math.max(0.12 * (most - least), 0.2);
  const hasZero = values.includes(0);
  const place = value => value > 0 ? Math.log10(value) : least - gap;
  const marks = own ? positive.map(value => ({value: place(value), text: tandem.number(value)})) : powers.map(value => ({value, text: tandem.powerText(value)}));
  const zero = hasZero ? [{value: place(0), text: "0"}] : [];
  const ticks = [...zero, ...tandem.apart(marks, (most - least) / (innerWidth < 640 ? 6 : 16))];
  const pad = 0.03 * (most - least) || 0.1;
  return {place, ticks, axis: {type: "linear", min: (hasZero ? place(0) : least) - pad, max: most + pad, title: {display: true, text: text + ", logarithmic"},
    afterBuildTicks: scale => { scale.ticks = ticks.map(({value}) => ({value})); },
    ticks: {autoSkip: false, maxRotation: 45, callback: (_, i) => ticks[i].text}}};
};

/** An axis of numbers, with ticks of the chart's library; logarithmic if `more` has this type, or if values differ by a factor above ten and none is 0. */
tandem.axis = (text, values, more) => {
  const known = values.filter(value => value !== null && value !== undefined);
  const least = Math.min(...known);
  const most = Math.max(...known);
  const title = {display: true, text};
  if (!(least > 0 && most / least > 10) && more?.type !== "logarithmic") return {type: "linear", beginAtZero: true, title, ticks: {maxRotation: 45, callback: value => tandem.number(value)}, ...more};
  // Ticks at powers of ten, and also at their doubles and quintuples if there are few: more would overlap.
  const shown = most / least > 1000 ? [1] : most / least > 5 ? [1, 2, 5] : [1, 2, 3, 4, 5, 6, 7, 8, 9];
  return {type: "logarithmic", title: {display: true, text: text + ", logarithmic"}, ticks: {maxRotation: 0, autoSkip: true, callback: value => tandem.number(value)},
    afterBuildTicks: scale => { scale.ticks = scale.ticks.filter(({value}) => shown.includes(+value.toExponential(3).split("e")[0])); }, ...more};
};
