// SPDX-License-Identifier: MIT
// The first chart: a row for each comparison, a mark for each method, on a logarithmic axis of time.
"use strict";

/** A text in lines of at most `length` letters, if its parts between commas allow it. */
tandem.lines = (text, length) => text.split(/(?<=,) /).reduce((lines, part) => {
  const last = lines[lines.length - 1];
  return last !== undefined && (last + " " + part).length <= length ? [...lines.slice(0, -1), `${last} ${part}`] : [...lines, part];
}, []);

/** Marks of methods, none of which looks crossed out. */
tandem.methodMarker = method => ["circle", "rect", "triangle", "rectRot", "star", "rectRounded"][method % 6];

/** Colours and marks of cells that are called by their methods, as in the first chart; nothing if one is not. */
tandem.methodColours = ({overview: {methods}}, cells) => {
  const places = cells.map(cell => methods.indexOf(cell.label));
  return places.map(place => places.includes(-1) ? {} : {colour: place, pointStyle: tandem.methodMarker(place)});
};

/** The numbers of all comparisons: cells with their ratios to the fastest. */
tandem.comparisonRows = groups => groups.flatMap(group => group.ranked.map(([, ratio, low, high, apart], i) =>
  [group.row, group.cells[i].label, group.cells[i].ms[0], tandem.intervalText(group.cells[i]), ratio,
    i === 0 ? "" : apart === null ? tandem.fewRounds : tandem.brackets(low, high), i === 0 || apart === null ? "" : apart ? "yes" : "no"]));

/** Points of a method: those of its fastest cells, or of its wrong ones, which are crossed out. */
tandem.methodPoints = (cells, rows, method, methods) => {
  const own = rows.map(row => row.marks[method] === null && row.wrong[method] === null ? null : cells[row.marks[method] ?? row.wrong[method]]);
  const leads = rows.map(row => row.leaders[method]);
  return {label: methods[method], colour: method, pointStyle: tandem.methodMarker(method), showLine: false, data: own.map(cell => cell && cell.ms[0]), namesLeft: true, pointRadius: leads.map(leader => leader ? 7 : 5),
    intervals: own.map(cell => cell && cell.rounds > 1 ? cell.ms.slice(1) : null), crossed: rows.map(row => row.marks[method] === null && row.wrong[method] !== null),
    names: own.map((cell, i) => leads[i] ? `${innerWidth < 640 ? "" : methods[method]} ${cell.ms[0].toPrecision(3)}` : ""),
    texts: own.map((cell, i) => cell && [`${rows[i].name}: ${cell.label}, ${tandem.timeText(cell)}${rows[i].marks[method] === null ? ", WRONG" : ""}`, rows[i].key])};
};

tandem.overviewFigure = data => {
  const {title, methods, rows, left} = data.overview;
  return rows.length && new tandem.Figure({part: "results", id: "overview", describe: () => {
    const datasets = methods.map((_, method) => tandem.methodPoints(data.cells, rows, method, methods));
    const times = rows.flatMap(row => [...row.marks, ...row.wrong]).filter(number => number !== null).flatMap(number => data.cells[number].ms).filter(ms => ms > 0);
    const labels = rows.map(({name}) => tandem.lines(name, innerWidth < 640 ? 20 : 40));
    const height = 16 + 14 * Math.max(...labels.map(lines => lines.length));
    const [least, most] = [Math.min(...times), Math.max(...times)];  // with space for a name on the left
    const ends = {type: "logarithmic", min: least / (most / least) ** (innerWidth < 640 ? 0.25 : 0.12), max: most * (most / least) ** 0.03};
    return {title, alt: `Milliseconds per frame of ${tandem.count(methods.length, "method", "methods")} in ${tandem.count(rows.length, "row", "rows")}.`,
      notes: [rows.some(row => row.wrong.some(cell => cell !== null)) && {text: "A cross marks a wrong answer.", bad: true}, left && {text: `${left} more rows are in the table of times.`}].filter(note => note), type: "line", height: 120 + height * rows.length,
      data: {labels, datasets},
      options: {indexAxis: "y", scales: {x: tandem.axis("ms per frame, 95 % intervals", times, ends), y: {offset: true, ticks: {autoSkip: false}}}},
      table: ["Cells of each comparison, the fastest first", ["comparison", "cell", "ms per frame", "95 %", "times the fastest", "95 % of this ratio", "told apart"],
        tandem.comparisonRows(data.groups).slice(0, 300)]};
  }});
};
