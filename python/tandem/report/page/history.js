// SPDX-License-Identifier: MIT
// The trend of a cell over commits. The program has compared them.
"use strict";

tandem.historyFigure = data => data.history && new tandem.Figure({id: "history", label: "cell", choices: data.history.cells.map((cell, value) => ({value, text: cell.label})), describe: number => {
  const {programs, cells, left_out} = data.history;
  const {title, label, points} = cells[number];
  const texts = points.map(([program, ms, , , ratio, moved, verdict]) => `${programs[program]}: ${tandem.number(ms)} ms a frame` + (ratio ? `, ${tandem.number(ratio[0])} times the level before${(ratio[1] === null ? "" : " " + tandem.brackets(ratio[1], ratio[2]))}: ${verdict}` : verdict && `, ${verdict}`));
  const at = isMoved => programs.map((_, program) => points.find(point => point[0] === program && (!isMoved || point[5]))?.[1] ?? null);
  const ofProgram = programs.map((_, program) => texts[points.findIndex(point => point[0] === program)]);
  return {title, alt: `${label}: milliseconds a frame over ${programs.length} commits.`, type: "line",
    notes: [{text: "A commit moved if 'tandem compare' finds it slower, faster or with another answer than the first commit of the level before. Sessions of a commit are pooled." +
      (left_out ? ` ${left_out} cells are left out.` : "")}],
    data: {labels: programs, datasets: [{label: "moved", data: at(true), showLine: false, colour: 4, pointStyle: "rectRot", pointRadius: 9, texts: ofProgram},
      {label: "ms a frame", data: at(false), spanGaps: true, colour: 1, borderWidth: 2, texts: ofProgram}]},
    options: {scales: {x: {title: {display: true, text: "commit, the oldest first"}}, y: {...tandem.axis("ms a frame", points.map(point => point[1])), beginAtZero: true}}},
    table: [label, ["commit", "ms a frame", "rounds", "sessions", "times the level before", "95 %", "verdict"], points.map(([program, ms, rounds, sessions, ratio, , verdict]) =>
      [programs[program], ms, rounds, sessions, ratio ? ratio[0] : "", ratio ? tandem.brackets(ratio[1], ratio[2]) : "", verdict])]};
}});
