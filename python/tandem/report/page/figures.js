// SPDX-License-Identifier: MIT
// The charts of the page. A chart without records is left out.
"use strict";

tandem.groupChoices = groups => groups.map(group => ({value: group.number, text: group.title}));

/** Times of each frame. */
tandem.curvesFigure = data => {
  const groups = data.groups.filter(group => group.cells.some(cell => cell.curve));
  return groups.length && new tandem.Figure({id: "curves", label: "comparison", choices: tandem.groupChoices(groups), describe: number => {
    const group = data.groups[number];
    const cells = group.cells.filter(cell => cell.curve).slice(0, 8);
    const {first, curve} = cells[0];
    const worst = curve.indexOf(Math.max(...curve));
    const all = cells.flatMap(cell => cell.curve);
    const colours = tandem.methodColours(data, cells);
    return {title: `${tandem.shortened(cells[0].label, 60)} takes ${tandem.number(Math.min(...curve))} to ${tandem.number(curve[worst])} ms, most in frame ${first + worst}`,
      alt: `${group.title}: milliseconds of each frame, the median of the replays, of ${cells.length} cells.`, type: "line",
      data: {labels: curve.map((_, i) => first + i), datasets: cells.map((cell, i) => ({label: tandem.shortened(cell.label, 60), data: cell.curve, ...colours[i],
        pointRadius: curve.length > 60 ? 0 : 3, borderWidth: 2}))},
      options: {scales: {x: {title: {display: true, text: "frame"}}, y: tandem.axis("ms", all)}},
      table: [group.title, ["frame", ...cells.map(cell => cell.label)], curve.map((_, i) => [String(first + i), ...cells.map(cell => cell.curve[i])])]};
  }});
};

/** Times of steps of a simulation by part. */
tandem.simulationsFigure = data => {
  const runs = data.simulations.filter(run => run.kept.length);
  return runs.length && new tandem.Figure({id: "simulations", label: "simulation",
    choices: runs.map((run, value) => ({value, text: `${run.name}: ${tandem.count(run.steps, "step", "steps")}, ${run.status}`})), describe: number => {
      const run = runs[number];
      const sums = run.parts.map((part, i) => [part, run.kept.reduce((sum, step) => sum + step[i + 1], 0)]).sort((a, b) => b[1] - a[1]);
      const all = sums.reduce((sum, entry) => sum + entry[1], 0);
      return {title: `The part ${sums[0][0]} takes ${Math.round(100 * sums[0][1] / all)} % of the steps' time` + (run.status === "ok" ? "" : `; the run is ${run.status}${run.failure ? ": " + run.failure : ""}`),
        alt: `${run.name}: milliseconds of a step by part, ${run.kept.length} of ${run.steps} steps.`, type: "line",
        data: {labels: run.kept.map(step => step[0]), datasets: run.parts.map((part, i) => ({label: part, data: run.kept.map(step => step[i + 1]), fill: true,
          pointRadius: 0, borderWidth: 1, pointStyle: "rect"}))},
        options: {scales: {x: {title: {display: true, text: "step"}}, y: {stacked: true, title: {display: true, text: "ms of the host"}}}},
        table: [run.name, ["step", ...run.parts, "contacts found", "contacts kept"], run.kept.map(([step, ...rest]) => [String(step), ...rest])]};
    }});
};

/** Ratios of new to old records, as of tandem compare. */
tandem.differencesFigure = differences => differences && new tandem.Figure({id: "differences", describe: () => {
  const timed = differences.cells.filter(cell => cell.ratio).sort((a, b) => Math.abs(Math.log(b.ratio[0])) - Math.abs(Math.log(a.ratio[0])));
  const shown = timed.slice(0, 40).sort((a, b) => b.ratio[0] - a.ratio[0]);
  const limits = shown.flatMap(cell => cell.ratio).filter(value => value !== null);
  const left = differences.of - shown.length;
  return {title: differences.title,
    alt: `New time over old time with 95 % intervals; 1 is no change. ${differences.common}. ${differences.notes.join(" ")}` + (left ? ` ${left} cells that changed less are in the table or left out.` : ""),
    type: "line", height: 110 + 26 * shown.length,
    data: {labels: shown.map(cell => tandem.shortened(cell.label, tandem.nameLength())), datasets: [{label: "new / old", data: shown.map(cell => cell.ratio[0]), showLine: false,
      intervals: shown.map(cell => cell.ratio[1] === null ? null : cell.ratio.slice(1)), colour: 1}]},
    options: {indexAxis: "y", scales: {x: {title: {display: true, text: "new time over old time, 95 % intervals; above 1 is slower"}, suggestedMin: Math.min(0.95, ...limits), suggestedMax: Math.max(1.05, ...limits),
      grid: {lineWidth: mark => mark.tick && mark.tick.value === 1 ? 3 : 1, color: mark => tandem.ofStyle(mark.tick && mark.tick.value === 1 ? "--text" : "--grid")}},
      y: {offset: true, ticks: {autoSkip: false}}}},
    table: [[differences.common, ...differences.notes].join("; "), ["cell", "old ms per frame", "new ms per frame", "new/old", "95 %", "p (Holm)", "verdict"],
      differences.cells.map(cell => [cell.label, cell.old, cell.new, ...(cell.ratio ? [cell.ratio[0], tandem.brackets(cell.ratio[1], cell.ratio[2])] : ["", ""]), cell.p, cell.verdict])]};
}});

/** The trend of a cell over commits. The program has compared them. */
tandem.historyFigure = data => data.history && new tandem.Figure({id: "history", label: "cell", choices: data.history.cells.map((cell, value) => ({value, text: cell.label})), describe: number => {
  const {programs, cells, left_out} = data.history;
  const {title, label, points} = cells[number];
  const texts = points.map(([program, ms, , , ratio, moved, verdict]) => `${programs[program]}: ${tandem.number(ms)} ms per frame` + (ratio ? `, ${tandem.number(ratio[0])} times the level before${(ratio[1] === null ? "" : " " + tandem.brackets(ratio[1], ratio[2]))}: ${verdict}` : verdict && `, ${verdict}`));
  const at = isMoved => programs.map((_, program) => points.find(point => point[0] === program && (!isMoved || point[5]))?.[1] ?? null);
  const ofProgram = programs.map((_, program) => texts[points.findIndex(point => point[0] === program)]);
  return {title, alt: `${label}: milliseconds per frame over ${programs.length} commits.`, type: "line",
    notes: [{text: "A commit moved if 'tandem compare' finds it slower, faster or with another answer than the first commit of the level before. Sessions of a commit are pooled." +
      (left_out ? ` ${left_out} cells are left out.` : "")}],
    data: {labels: programs, datasets: [{label: "moved", data: at(true), showLine: false, colour: 4, pointStyle: "rectRot", pointRadius: 9, texts: ofProgram},
      {label: "ms per frame", data: at(false), spanGaps: true, colour: 1, borderWidth: 2, texts: ofProgram}]},
    options: {scales: {x: {title: {display: true, text: "commit, the oldest first"}}, y: {...tandem.axis("ms per frame", points.map(point => point[1])), beginAtZero: true}}},
    table: [label, ["commit", "ms per frame", "rounds", "sessions", "times the level before", "95 %", "verdict"], points.map(([program, ms, rounds, sessions, ratio, , verdict]) =>
      [programs[program], ms, rounds, sessions, ratio ? ratio[0] : "", ratio ? tandem.brackets(ratio[1], ratio[2]) : "", verdict])]};
}});

/** Times over one numeric setting. */
tandem.sweepsFigure = data => data.sweeps.length && new tandem.Figure({id: "sweeps", label: "setting and scene",
  choices: data.sweeps.map(({setting, of, all}, value) => ({value, text: `${setting}: ${of} (${tandem.count(all, "line", "lines")})`})), describe: number => {
    const {setting, of, all, title, lines} = data.sweeps[number];
    const points = lines.map(line => line.points.map(([value, index]) => [value, data.cells[index]]));
    const values = points.flat().map(point => point[0]);
    const isNegative = values.some(value => value < 0);
    const scale = isNegative ? {place: value => value, axis: tandem.axis(setting, values, {beginAtZero: false})} : tandem.logScale(setting, values, true);
    return {title, alt: `${of}: milliseconds per frame over ${setting}, ${lines.length} of ${all} lines.`, type: "line",
      data: {datasets: lines.map((line, i) => ({label: tandem.shortened(line.name, 60), data: points[i].map(([value, cell]) => ({x: scale.place(value), y: cell.ms[0]})),
        intervals: points[i].map(([, cell]) => cell.rounds > 1 ? cell.ms.slice(1) : null),
        texts: points[i].map(([value, cell]) => `${line.name}, ${setting} = ${tandem.number(value)}: ${tandem.timeText(cell)}`)}))},
      options: {scales: {x: {...scale.axis, type: "linear"}, y: tandem.axis("ms per frame", points.flat().map(([, cell]) => cell.ms[0]))}},
      table: [of, ["line", setting, "ms per frame", "95 %"], lines.flatMap((line, i) => points[i].map(([value, cell]) => [line.name, value, cell.ms[0], tandem.intervalText(cell)]))]};
  }});

tandem.charts = data => {
  data.groups.forEach((group, number) => Object.assign(group, {number, cells: group.ranked.map(entry => data.cells[entry[0]])}));
  for (const figure of [tandem.overviewFigure(data), tandem.stagesFigure(data), tandem.differencesFigure(data.differences), tandem.historyFigure(data), tandem.sweepsFigure(data),
    tandem.curvesFigure(data), tandem.errorFigure(data), tandem.rooflineFigure(data), tandem.simulationsFigure(data)])
    if (figure) figure.show();
};
