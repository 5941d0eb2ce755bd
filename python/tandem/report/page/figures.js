// SPDX-License-Identifier: MIT
// The charts of the page. A chart without records is left out.
"use strict";

tandem.groupChoices = groups => groups.map(group => ({value: group.number, text: group.title}));
tandem.maxBars = 30;

/** Medians of cells with intervals, the fastest on top. */
tandem.mediansFigure = data => {
  const groups = data.groups.filter(group => group.ranked.length > 1);
  return groups.length && new tandem.Figure({id: "medians", label: "comparison", choices: tandem.groupChoices(groups), describe: number => {
    const group = data.groups[number];
    const cells = group.ranked.slice(0, tandem.maxBars).map(entry => data.cells[entry[0]]);
    const [second] = group.ranked.slice(1);
    const name = tandem.shortened(cells[0].label, 60);
    const left = group.ranked.length - cells.length;
    const lead = `${name} is the fastest, ${tandem.number(second[1])} times as fast as the next`;
    return {title: group.differ ? "Answers differ: these times are of different work" : second[4] ? lead
        : second[4] === null ? `${lead} (one round: no interval)` : `${name} and the next are not told apart`,
      alt: `${group.title}: milliseconds a frame of ${cells.length} cells.` + (left ? ` ${left} slower ones are in the table of every cell.` : ""),
      type: "line", height: 110 + 26 * cells.length,
      data: {labels: cells.map(cell => tandem.shortened(cell.label, tandem.nameLength())), datasets: [{label: "ms a frame", data: cells.map(cell => cell.ms[0]), showLine: false,
        intervals: cells.map(cell => cell.rounds > 1 ? cell.ms.slice(1) : null), colour: 1}]},
      options: {indexAxis: "y", scales: {x: tandem.axis("milliseconds a frame, 95 % intervals", cells.flatMap(cell => cell.ms)), y: {offset: true, ticks: {autoSkip: false}}}},
      table: [group.title, ["cell", "ms a frame", "low", "high", "times the fastest's"],
        group.ranked.slice(0, 200).map(([index, ratio]) => [data.cells[index].label, ...data.cells[index].ms, ratio])]};
  }});
};

/** Cells that differ only in one numeric setting: {setting, of, lines}. */
tandem.sweeps = data => {
  const cells = data.cells.filter(cell => cell.status === "ok" && cell.ms && !cell.older);
  const values = {};
  for (const cell of cells)
    for (const [name, value] of Object.entries(cell.settings)) (values[name] ??= new Set()).add(value);
  const names = Object.keys(values).filter(name => values[name].size > 2 && [...values[name]].every(value => value !== "" && isFinite(value)));
  return names.flatMap(setting => {
    const lines = new Map();
    for (const cell of cells) {
      if (!(setting in cell.settings)) continue;
      const {[setting]: value, ...rest} = cell.settings;
      const scene = cell.scene.split(":")[0];
      const key = JSON.stringify([cell.algorithm, cell.preset, cell.device, scene, cell.frames, rest]);
      if (!lines.has(key)) lines.set(key, {cell, of: `${scene}, frames ${cell.frames}, on ${cell.device}`, points: new Map()});
      lines.get(key).points.set(+value, cell);
    }
    const long = [...lines.values()].filter(line => line.points.size > 2);
    return [...new Set(long.map(line => line.of))].map(of => ({setting, of, lines: long.filter(line => line.of === of)}));
  });
};

/** Names of the lines of a chart: algorithm, preset and the settings in which they differ. */
tandem.lineNames = lines => lines.map(({cell}, i) => {
  const others = lines.filter((_, j) => j !== i);
  const differing = Object.entries(cell.settings).filter(([name, value]) =>
    others.some(other => other.cell.algorithm === cell.algorithm && other.cell.settings[name] !== value && !other.points.has(+value)));
  return tandem.shortened([cell.algorithm, cell.preset, ...differing.map(([name, value]) => `${name}=${value}`)].join(" "), 60);
});

tandem.sweepsFigure = data => {
  const sweeps = tandem.sweeps(data);
  return sweeps.length && new tandem.Figure({id: "sweeps", label: "setting and scene",
    choices: sweeps.map(({setting, of, lines}, value) => ({value, text: `${setting}: ${of} (${tandem.count(lines.length, "line", "lines")})`})), describe: number => {
      const {setting, of, lines} = sweeps[number];
      const shown = lines.slice(0, 8);
      const names = tandem.lineNames(shown);
      const points = line => [...line.points].sort((a, b) => a[0] - b[0]);
      const best = shown.flatMap((line, i) => points(line).map(([value, cell]) => ({value, ms: cell.ms[0], name: names[i]}))).reduce((a, b) => a.ms <= b.ms ? a : b);
      const all = shown.flatMap(points);
      return {title: `${setting} = ${tandem.number(best.value)} is the fastest of its values here, with ${tandem.number(best.ms)} ms a frame (${best.name})`,
        alt: `${of}: milliseconds a frame over ${setting}, ${shown.length} of ${lines.length} lines.`, type: "line",
        data: {datasets: shown.map((line, i) => ({label: names[i], data: points(line).map(([x, cell]) => ({x, y: cell.ms[0]})),
          intervals: points(line).map(([, cell]) => cell.rounds > 1 ? cell.ms.slice(1) : null)}))},
        options: {scales: {x: tandem.axis(setting, all.map(point => point[0]), {beginAtZero: false}), y: tandem.axis("ms a frame", all.map(([, cell]) => cell.ms[0]))}},
        table: [of, ["line", setting, "ms a frame", "low", "high"], shown.flatMap((line, i) => points(line).map(([value, cell]) => [names[i], value, ...cell.ms]))]};
    }});
};

/** Times by stage of each cell: the device's time, or the host's for stages without device time. */
tandem.stagesFigure = data => {
  const groups = data.groups.filter(group => group.ranked.some(entry => Object.keys(data.cells[entry[0]].stages).length));
  const timed = ([device, host]) => device > 0 ? device : host;
  return groups.length && new tandem.Figure({id: "stages", label: "comparison", choices: tandem.groupChoices(groups), describe: number => {
    const group = data.groups[number];
    const cells = group.ranked.slice(0, 20).map(entry => data.cells[entry[0]]);
    const names = [...new Set(cells.flatMap(cell => Object.keys(cell.stages)))];
    const time = (cell, name) => cell.stages[name] ? timed(cell.stages[name]) : 0;
    const own = names.map(name => [name, time(cells[0], name)]).sort((a, b) => b[1] - a[1]);
    const all = own.reduce((sum, entry) => sum + entry[1], 0);
    return {title: own.length && all > 0 ? `${own[0][0]} takes ${Math.round(100 * own[0][1] / all)} % of the stages of the fastest, ${tandem.shortened(cells[0].label, 60)}`
        : "The fastest has no times by stage",
      alt: `${group.title}: milliseconds a frame by stage, the device's time where a stage has any, otherwise the host's.`,
      type: "bar", height: 150 + 26 * cells.length,
      data: {labels: cells.map(cell => tandem.shortened(cell.label, tandem.nameLength())), datasets: names.map((name, i) => ({label: name, data: cells.map(cell => time(cell, name)),
        borderColor: tandem.ofStyle("--ground"), borderWidth: 1, pointStyle: "rect", colour: i}))},
      options: {indexAxis: "y", scales: {x: {stacked: true, title: {display: true, text: "milliseconds a frame, with a clock around every command"}}, y: {stacked: true, ticks: {autoSkip: false}}}},
      table: [group.title, ["cell", ...names], cells.map(cell => [cell.label, ...names.map(name => time(cell, name))])]};
  }});
};

/** Roofline chart: kernels under the ceilings of their device. */
tandem.rooflineFigure = data => data.profiles.length && new tandem.Figure({id: "roofline", label: "profile",
  choices: data.profiles.map((profile, value) => ({value, text: profile.name})), describe: number => {
    const {kernels, ceilings, name} = data.profiles[number];
    const both = kernels.filter(kernel => kernel.bytes > 0 && kernel.operations > 0);
    const ofBytes = kernel => kernel.operations / kernel.bytes;
    const bends = ceilings.operations_per_s / ceilings.bytes_per_s;
    const ends = [Math.min(bends, ...both.map(ofBytes)) / 3, Math.max(bends, ...both.map(ofBytes)) * 3];
    const under = x => Math.min(x * ceilings.bytes_per_s, ceilings.operations_per_s);
    const longest = kernels[0];
    const reached = kernel => Math.max(kernel.of_bytes ?? 0, kernel.of_operations ?? 0);
    return {title: longest ? `${longest.entry} takes ${Math.round(100 * longest.share)} % of the kernels' time and reaches ${Math.round(100 * reached(longest))} % of a ceiling`
        : "The profile has no kernels",
      alt: `${name}: comparisons a second over comparisons per byte of ${both.length} kernels that declare both, under the ceilings of the device.`,
      type: "scatter",
      data: {datasets: [{label: "ceiling", data: [ends[0], bends, ends[1]].map(x => ({x, y: under(x)})), showLine: true, pointRadius: 0, colour: 6},
        ...both.slice(0, 7).map((kernel, i) => ({label: kernel.entry, data: [{x: ofBytes(kernel), y: kernel.operations_per_s}], colour: i, pointRadius: 7}))]},
      options: {scales: {x: tandem.logarithmic("comparisons per byte", true),
        y: tandem.logarithmic("comparisons a second", true)}},
      table: [name, ["kernel", "stage", "ms a frame", "share", "bytes a second", "of their ceiling", "comparisons a second", "of their ceiling", "times its floor", "bound"],
        kernels.map(kernel => [kernel.entry, kernel.stage, kernel.ms[0], kernel.share, kernel.bytes_per_s, kernel.of_bytes, kernel.operations_per_s, kernel.of_operations,
          kernel.over_floor, kernel.bound ?? "not known"])]};
  }});

tandem.errors = [["depth_relative", "error of depth, relative, median"], ["normal_degrees", "error of normals, degrees, median"],
  ["hausdorff", "error of the contacts' hull, median"], ["volume_relative", "error of volume, relative, median"], ["false_share", "share of candidate pairs that do not meet"],
  ["missed_share", "share of meeting pairs that are missed"]];

/** Time over error, with the Pareto-optimal cells marked: no other cell is better in one and at least equal in the other. */
tandem.errorFigure = data => {
  const cells = data.cells.filter(cell => cell.error && cell.ms && cell.status === "ok" && !cell.older);
  const of = cell => `${cell.scene}, on ${cell.device}`;
  const choices = [...new Set(cells.map(of))].flatMap(where => tandem.errors.filter(([name]) => cells.filter(cell => of(cell) === where && cell.error[name] > 0).length > 1)
    .map(([name, text]) => ({value: JSON.stringify([where, name]), text: `${text}: ${where}`})));
  return choices.length && new tandem.Figure({id: "error", label: "error and scene", choices, describe: value => {
    const [where, name] = JSON.parse(value);
    const own = cells.filter(cell => of(cell) === where && typeof cell.error[name] === "number");
    const least = Math.min(...own.map(cell => cell.error[name]).filter(error => error > 0));
    const at = cell => Math.max(cell.error[name], least / 10);  // cells without error are at the left
    const label = cell => `${cell.algorithm} k=${cell.settings.k} ${["contact_rule", "decision", "rounding"].map(s => cell.settings[s] ?? "").join(" ")}`;
    const unbeaten = own.filter(cell => !own.some(other => other !== cell && other.ms[0] <= cell.ms[0] && other.error[name] <= cell.error[name] &&
      (other.ms[0] < cell.ms[0] || other.error[name] < cell.error[name])));
    const others = own.filter(cell => !unbeaten.includes(cell));
    const fastest = unbeaten.reduce((a, b) => a.ms[0] <= b.ms[0] ? a : b);
    const best = unbeaten.reduce((a, b) => a.error[name] <= b.error[name] ? a : b);
    const points = list => list.map(cell => ({x: at(cell), y: cell.ms[0]}));
    const what = tandem.errors.find(entry => entry[0] === name)[1];
    return {title: fastest === best ? `${label(best)} is the fastest and has the least error`
        : `${label(best)} has the least error and takes ${tandem.number(best.ms[0] / fastest.ms[0])} times as long as the fastest, ${label(fastest)}`,
      alt: `${where}: milliseconds a frame over ${what}, of ${own.length} cells; ${unbeaten.length} are beaten by none in both. Errors of 0 are at the left.`,
      type: "scatter",
      data: {datasets: [{label: "beaten by none in both", data: points(unbeaten), intervals: unbeaten.map(cell => cell.ms.slice(1)), colour: 4, pointStyle: "rectRot", pointRadius: 7},
        {label: "others", data: points(others), intervals: others.map(cell => cell.ms.slice(1)), colour: 6}]},
      options: {scales: {x: tandem.logarithmic(what, true),
        y: tandem.axis("ms a frame", own.map(cell => cell.ms[0]))}},
      table: [where, ["cell", "preset", what, "ms a frame", "low", "high", "beaten by none"], [...unbeaten, ...others].slice(0, 300).map(cell =>
        [label(cell), cell.preset, cell.error[name], ...cell.ms, unbeaten.includes(cell) ? "yes" : "no"])]};
  }});
};

/** Times of each frame. */
tandem.curvesFigure = data => {
  const groups = data.groups.filter(group => group.ranked.some(entry => data.curves[entry[0]]));
  return groups.length && new tandem.Figure({id: "curves", label: "comparison", choices: tandem.groupChoices(groups), describe: number => {
    const group = data.groups[number];
    const cells = group.ranked.map(entry => data.cells[entry[0]]).filter(cell => data.curves[cell.index]).slice(0, 8);
    const first = +group.cells[0].frames.split(":")[0];
    const curve = data.curves[cells[0].index];
    const worst = curve.indexOf(Math.max(...curve));
    const all = cells.flatMap(cell => data.curves[cell.index]);
    return {title: `The slowest frame of ${tandem.shortened(cells[0].label, 60)} is frame ${first + worst}, with ${tandem.number(curve[worst])} ms`,
      alt: `${group.title}: milliseconds of each frame, the median of the replays, of ${cells.length} cells.`, type: "line",
      data: {labels: curve.map((_, i) => first + i), datasets: cells.map(cell => ({label: tandem.shortened(cell.label, 60), data: data.curves[cell.index],
        pointRadius: curve.length > 60 ? 0 : 3, borderWidth: 2}))},
      options: {scales: {x: {title: {display: true, text: "frame"}}, y: tandem.axis("ms", all)}},
      table: [group.title, ["frame", ...cells.map(cell => cell.label)], curve.map((_, i) => [String(first + i), ...cells.map(cell => data.curves[cell.index][i])])]};
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
      return {title: `${sums[0][0]} takes ${Math.round(100 * sums[0][1] / all)} % of the steps' time` + (run.status === "ok" ? "" : `; the run is ${run.status} ${run.failure}`),
        alt: `${run.name}: milliseconds of a step by part, ${run.kept.length} of ${run.steps} steps.`, type: "line",
        data: {labels: run.kept.map(step => step[0]), datasets: run.parts.map((part, i) => ({label: part, data: run.kept.map(step => step[i + 1]), fill: true,
          pointRadius: 0, borderWidth: 1, pointStyle: "rect"}))},
        options: {scales: {x: {title: {display: true, text: "step"}}, y: {stacked: true, title: {display: true, text: "ms of the host"}}}},
        table: [run.name, ["step", ...run.parts, "contacts found", "contacts kept"], run.kept.map(([step, ...rest]) => [String(step), ...rest])]};
    }});
};

/** Ratios of new to old records, as of tandem compare. */
tandem.differencesFigure = differences => differences && new tandem.Figure({id: "differences", label: "", choices: [{value: 0, text: ""}], describe: () => {
  const timed = differences.cells.filter(cell => cell.ratio).sort((a, b) => Math.abs(Math.log(b.ratio[0])) - Math.abs(Math.log(a.ratio[0])));
  const shown = timed.slice(0, 40).sort((a, b) => b.ratio[0] - a.ratio[0]);
  const limits = shown.flatMap(cell => cell.ratio);
  const left = differences.of - shown.length;
  return {title: `${differences.new} against ${differences.old}: ${differences.summary}`,
    alt: `New time over old time with 95 % intervals; 1 is no change. ${differences.common}. ${differences.notes.join(" ")}` + (left ? ` ${left} cells that changed less are in the table or left out.` : ""),
    type: "line", height: 110 + 26 * shown.length,
    data: {labels: shown.map(cell => tandem.shortened(cell.label, tandem.nameLength())), datasets: [{label: "new / old", data: shown.map(cell => cell.ratio[0]), showLine: false,
      intervals: shown.map(cell => cell.ratio.slice(1)), colour: 1}]},
    options: {indexAxis: "y", scales: {x: {title: {display: true, text: "new time over old time, 95 % intervals; above 1 is slower"}, suggestedMin: Math.min(0.95, ...limits), suggestedMax: Math.max(1.05, ...limits),
      grid: {lineWidth: mark => mark.tick && mark.tick.value === 1 ? 3 : 1, color: mark => tandem.ofStyle(mark.tick && mark.tick.value === 1 ? "--text" : "--grid")}},
      y: {offset: true, ticks: {autoSkip: false}}}},
    table: [[differences.common, ...differences.notes].join("; "), ["cell", "old ms", "new ms", "new/old", "low", "high", "p (Holm)", "verdict"],
      differences.cells.map(cell => [cell.label, cell.old, cell.new, ...(cell.ratio ?? ["", "", ""]), cell.p, cell.verdict])]};
}});

tandem.charts = (data, differences) => {
  for (const figure of [tandem.differencesFigure(differences), tandem.mediansFigure(data), tandem.sweepsFigure(data), tandem.stagesFigure(data), tandem.curvesFigure(data),
    tandem.errorFigure(data), tandem.rooflineFigure(data), tandem.simulationsFigure(data)])
    if (figure) figure.show();
};
