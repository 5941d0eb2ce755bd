// SPDX-License-Identifier: MIT
// The chart of stages. Each stage has one fixed fill, and bars have the order of a frame's pipeline.
"use strict";

/** All stages in the order in which a frame runs them. */
tandem.stageOrder = ["preprocess", "write", "transform", "refit", "broad", "seed", "traverse", "balance", "sort", "contact", "reduce", "solve",
  "exchange", "read", "postprocess"];

/** Ten colours [on light, on dark background] that readers with any colour blindness can distinguish (tests/report/charts.py measures it). */
tandem.stageColours = {preprocess: ["#aa88aa", "#776655"], write: ["#223344", "#bbffbb"], transform: ["#552211", "#ffff88"],
  refit: ["#3399ee", "#00aaaa"], broad: ["#441166", "#cc99ff"], seed: ["#ee6666", "#88aa66"], traverse: ["#0055bb", "#446699"],
  balance: ["#994411", "#995500"], contact: ["#bb8811", "#ddaa33"], read: ["#665588", "#33ffee"]};

/** Stages that few cells have: the colour of another stage, with stripes. */
tandem.stripedStages = {sort: "seed", reduce: "contact", solve: "traverse", exchange: "write", postprocess: "preprocess"};

tandem.smallShare = 0.03;  // of a bar
tandem.smallStages = "small stages";

/** Stripes of a colour on the background of the page. */
tandem.stripes = colour => {
  const tile = tandem.element("canvas", {width: 8, height: 8});
  const draw = tile.getContext("2d");
  draw.fillStyle = tandem.ofStyle("--ground");
  draw.fillRect(0, 0, 8, 8);
  draw.strokeStyle = colour;
  draw.lineWidth = 3;
  for (const x of [-8, 0, 8]) {
    draw.beginPath();
    draw.moveTo(x, 8);
    draw.lineTo(x + 8, 0);
    draw.stroke();
  }
  return draw.createPattern(tile, "repeat");
};

tandem.stageFill = name => {
  const dark = tandem.darkness.matches ? 1 : 0;
  const plain = tandem.stageColours[name];
  if (plain) return plain[dark];
  const like = tandem.stripedStages[name];
  return tandem.stripes(like ? tandem.stageColours[like][dark] : tandem.ofStyle("--quiet"));
};

/** Names of the stages of `bars`, a list of {stage: ms}, in order: {shown, folded}. A stage is folded if its share of each bar is below
 * smallShare; a single such stage is shown. Unknown stages come last. */
tandem.foldedStages = bars => {
  const place = name => (tandem.stageOrder.indexOf(name) + tandem.stageOrder.length + 1) % (tandem.stageOrder.length + 1);
  const names = [...new Set(bars.flatMap(bar => Object.keys(bar)))].sort((a, b) => place(a) - place(b));
  const isSmall = name => bars.every(bar => (bar[name] ?? 0) < tandem.smallShare * Object.values(bar).reduce((sum, ms) => sum + ms, 0) || !bar[name]);
  const folded = names.filter(isSmall);
  return folded.length > 1 ? {shown: names.filter(name => !folded.includes(name)), folded} : {shown: names, folded: []};
};

/** Times by stage of each cell: the device's time, or the host's for stages without device time. */
tandem.stagesFigure = data => {
  const groups = data.groups.filter(group => group.cells.some(cell => Object.keys(cell.stages).length));
  return groups.length && new tandem.Figure({part: "results", id: "stages", label: "comparison", choices: tandem.groupChoices(groups), describe: number => {
    const group = data.groups[number];
    const cells = group.cells.slice(0, 20);
    const bars = cells.map(cell => cell.stages);
    const {shown, folded} = tandem.foldedStages(bars);
    const all = Object.values(bars[0]).reduce((sum, ms) => sum + ms, 0);
    const longest = Object.keys(bars[0]).sort((a, b) => bars[0][b] - bars[0][a])[0];
    const colours = name => ({label: name, backgroundColor: tandem.stageFill(name), borderColor: tandem.ofStyle("--ground"), borderWidth: 1, pointStyle: "rect"});
    const datasets = shown.map(name => ({...colours(name), data: bars.map(bar => bar[name] ?? 0)}));
    if (folded.length) datasets.push({...colours(tandem.smallStages), data: bars.map(bar => folded.reduce((sum, name) => sum + (bar[name] ?? 0), 0))});
    const ordered = [...shown, ...folded];
    return {title: group.stages ? group.stages : all > 0 ? `Stage ${longest} takes ${Math.round(100 * bars[0][longest] / all)} % of the time of ${tandem.shortened(cells[0].label, 60)}`
        : `${tandem.shortened(cells[0].label, 60)} has no times by stage`,
      alt: `${group.title}: milliseconds per frame by stage, the device's time where a stage has any, otherwise the host's.`,
      notes: folded.length ? [{text: `Small stages, each below ${100 * tandem.smallShare} % of every bar: ${folded.join(", ")}.`}] : [],
      type: "bar", height: 150 + 26 * cells.length,
      data: {labels: cells.map(cell => tandem.shortened(cell.label, tandem.nameLength())), datasets},
      options: {indexAxis: "y", scales: {x: {stacked: true, title: {display: true, text: "ms per frame, every command timed"}}, y: {stacked: true, ticks: {autoSkip: false}}}},
      table: [group.title, ["cell", ...ordered], cells.map((cell, i) => [cell.label, ...ordered.map(name => bars[i][name] ?? 0)])]};
  }});
};
