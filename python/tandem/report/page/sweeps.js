// SPDX-License-Identifier: MIT
// The chart of sweeps: times over one numeric setting.
"use strict";

tandem.sweepsFigure = data => data.sweeps.length && new tandem.Figure({id: "sweeps", label: "setting and scene",
  choices: data.sweeps.map(({setting, of, all}, value) => ({value, text: `${setting}: ${of} (${tandem.count(all, "line", "lines")})`})), describe: number => {
    const {setting, of, all, title, words, lines} = data.sweeps[number];
    const points = lines.map(line => line.points.map(([value, index]) => [value, data.cells[index]]));
    const values = points.flat().map(point => point[0]);
    const isNegative = values.some(value => value < 0);
    const scale = isNegative ? {place: value => value, axis: tandem.axis(setting, values, {beginAtZero: false})} : tandem.logScale(setting, values, true);
    return {title, alt: `${of}: milliseconds a frame over ${setting}, ${lines.length} of ${all} lines.`, notes: words ? [{text: words}] : [], type: "line",
      data: {datasets: lines.map((line, i) => ({label: tandem.shortened(line.name, 60), data: points[i].map(([value, cell]) => ({x: scale.place(value), y: cell.ms[0]})),
        intervals: points[i].map(([, cell]) => cell.rounds > 1 ? cell.ms.slice(1) : null),
        texts: points[i].map(([value, cell]) => `${line.name}, ${setting} = ${tandem.number(value)}: ${tandem.timeText(cell)}`)}))},
      options: {scales: {x: {...scale.axis, type: "linear"}, y: tandem.axis("ms a frame", points.flat().map(([, cell]) => cell.ms[0]))}},
      table: [of, ["line", setting, "ms a frame", "95 %"], lines.flatMap((line, i) => points[i].map(([value, cell]) => [line.name, value, cell.ms[0], tandem.intervalText(cell)]))]};
  }});
