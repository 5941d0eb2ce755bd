// SPDX-License-Identifier: MIT
// The roofline chart: kernels of a profile under the ceilings of their device.
"use strict";

/** The name of a kernel in words: "walk leaf tiles". */
tandem.kernelWords = entry => entry.replace(/_/g, " ");

/** What a kernel does, in the third person: "walks leaf tiles". Entries of kernels begin with a verb. */
tandem.kernelDoes = entry => {
  const [verb, ...rest] = entry.split("_");
  const does = /[^aeiou]y$/.test(verb) ? verb.slice(0, -1) + "ies" : /(s|x|ch|sh|o)$/.test(verb) ? verb + "es" : verb + "s";
  return [does, ...rest].join(" ");
};

tandem.percent = share => share === null || share === undefined ? "" : `${+(100 * share).toPrecision(3)} %`;

/** Sentences on kernels that exceed a ceiling, for which the ceiling or the count of work is wrong. */
tandem.ceilingWarnings = kernels => kernels.flatMap(kernel => [["of_bytes", "bytes"], ["of_operations", "comparisons"]].filter(([name]) => kernel[name] > 1)
  .map(([name, what]) => ({bad: true, text: `Warning: the kernel that ${tandem.kernelDoes(kernel.entry)} reaches ${tandem.percent(kernel[name])} of the ceiling of ${what}. ` +
    "More than 100 % is impossible: data stay in a cache, the clocks differ from those of the ceiling, or its work is counted too high."})));

tandem.rooflineFigure = data => data.profiles.length && new tandem.Figure({id: "roofline", label: "profile",
  choices: data.profiles.map((profile, value) => ({value, text: profile.name})), describe: number => {
    const {kernels, ceilings, conditions, name} = data.profiles[number];
    const both = kernels.filter(kernel => kernel.bytes > 0 && kernel.operations > 0);
    const ofBytes = kernel => kernel.operations / kernel.bytes;
    const bends = ceilings.operations_per_s / ceilings.bytes_per_s;
    const ends = [Math.min(bends, ...both.map(ofBytes)) / 3, Math.max(bends, ...both.map(ofBytes)) * 3];
    const under = x => Math.min(x * ceilings.bytes_per_s, ceilings.operations_per_s);
    const line = [ends[0], bends, ends[1]];
    const x = tandem.logScale("comparisons per byte", ends, false);
    const y = tandem.logScale("comparisons a second", [...line.map(under), ...both.map(kernel => kernel.operations_per_s)], false);
    const longest = kernels[0];
    const reached = kernel => Math.max(kernel.of_bytes ?? 0, kernel.of_operations ?? 0);
    return {title: longest ? `The kernel that ${tandem.kernelDoes(longest.entry)} takes ${Math.round(100 * longest.share)} % of the kernels' time and reaches ${tandem.percent(reached(longest))} of a ceiling`
        : "The profile has no kernels",
      alt: `${name}: comparisons a second over comparisons per byte of ${both.length} kernels that declare both, under the ceilings of the device.`,
      notes: [...tandem.ceilingWarnings(kernels), {text: `Ceilings: ${conditions}.`}],
      type: "scatter",
      data: {datasets: [{label: "ceiling", data: line.map(at => ({x: x.place(at), y: y.place(under(at))})), showLine: true, pointRadius: 0, colour: 6},
        ...both.slice(0, 7).map((kernel, i) => ({label: tandem.kernelWords(kernel.entry), data: [{x: x.place(ofBytes(kernel)), y: y.place(kernel.operations_per_s)}], colour: i, pointRadius: 7,
          texts: [`${tandem.kernelWords(kernel.entry)}: ${tandem.number(kernel.operations_per_s)} comparisons a second, ${tandem.number(ofBytes(kernel))} per byte`]}))]},
      options: {scales: {x: x.axis, y: y.axis}},
      table: [name, ["kernel", "entry", "stage", "ms per frame", "share", "bytes a second", "of their ceiling", "comparisons a second", "of their ceiling", "times its floor", "bound"],
        kernels.map(kernel => [tandem.kernelWords(kernel.entry), kernel.entry, kernel.stage, kernel.ms[0], tandem.percent(kernel.share), kernel.bytes_per_s, tandem.percent(kernel.of_bytes),
          kernel.operations_per_s, tandem.percent(kernel.of_operations), kernel.over_floor, kernel.bound ?? "not known"])]};
  }});
