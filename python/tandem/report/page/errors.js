// SPDX-License-Identifier: MIT
// The chart of time over error.
"use strict";

tandem.errors = [["depth_relative", "error of depth, relative, median"], ["normal_degrees", "error of normals, degrees, median"],
  ["hausdorff", "error of the contacts' hull, median"], ["volume_relative", "error of volume, relative, median"], ["false_share", "share of candidate pairs that do not meet"],
  ["missed_share", "share of meeting pairs that are missed"]];

/** Names of cells: those of their `names` that differ; at least the first, the algorithm. */
tandem.errorNames = cells => {
  const differs = cells[0].names.map((_, i) => new Set(cells.map(cell => cell.names[i])).size > 1);
  return new Map(cells.map(cell => [cell, cell.names.filter((name, i) => name && (differs[i] || (i === 0 && !differs.includes(true)))).join(" ")]));
};

/** Time over error, with the Pareto-optimal cells marked: no other cell is better in one and at least equal in the other. */
tandem.errorFigure = data => {
  const cells = data.cells.filter(cell => cell.error);
  const choices = [...new Set(cells.map(cell => cell.where))].flatMap(where => tandem.errors.filter(([name]) => cells.filter(cell => cell.where === where && cell.error[name] > 0).length > 1)
    .map(([name, text]) => ({value: JSON.stringify([where, name]), text: `${text}: ${where}`})));
  return choices.length && new tandem.Figure({id: "error", label: "error and scene", choices, describe: value => {
    const [where, name] = JSON.parse(value);
    const own = cells.filter(cell => cell.where === where && typeof cell.error[name] === "number");
    const names = tandem.errorNames(own);
    const unbeaten = own.filter(cell => !own.some(other => other !== cell && other.ms[0] <= cell.ms[0] && other.error[name] <= cell.error[name] &&
      (other.ms[0] < cell.ms[0] || other.error[name] < cell.error[name])));
    const others = own.filter(cell => !unbeaten.includes(cell));
    const quickest = unbeaten.reduce((a, b) => a.ms[0] <= b.ms[0] ? a : b);
    const best = unbeaten.reduce((a, b) => a.error[name] <= b.error[name] ? a : b);
    const what = tandem.errors.find(entry => entry[0] === name)[1];
    const scale = tandem.logScale(what, own.map(cell => cell.error[name]), false);
    const dataset = (list, more) => ({data: list.map(cell => ({x: scale.place(cell.error[name]), y: cell.ms[0]})), names: list.map(cell => names.get(cell)),
      intervals: list.map(cell => cell.rounds > 1 ? cell.ms.slice(1) : null),
      texts: list.map(cell => `${names.get(cell)}: error ${tandem.number(cell.error[name])}, ${tandem.timeText(cell)}`), ...more});
    return {title: quickest === best ? `${names.get(best)} is fastest and has the least error`
        : `${names.get(best)} has the least error, and takes ${(best.ms[0] / quickest.ms[0]).toPrecision(3)} times as long as ${names.get(quickest)}`,
      alt: `${where}: milliseconds per frame over ${what}, of ${own.length} cells; ${unbeaten.length} are beaten by none in both. Errors of 0 have a tick of their own at the left.`,
      type: "scatter", height: 420,
      data: {datasets: [dataset(unbeaten, {label: "beaten by none in both", colour: 4, pointStyle: "rectRot", pointRadius: 7}), dataset(others, {label: "others", colour: 6, pointRadius: 4})]},
      options: {scales: {x: scale.axis, y: tandem.axis("ms per frame", own.map(cell => cell.ms[0]))}},
      table: [where, ["cell", what, "ms per frame", "95 %", "beaten by none"], [...unbeaten, ...others].slice(0, 300).map(cell =>
        [names.get(cell), cell.error[name], cell.ms[0], tandem.intervalText(cell), unbeaten.includes(cell) ? "yes" : "no"])]};
  }});
};
