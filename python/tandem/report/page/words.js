// SPDX-License-Identifier: MIT
// The summary: sentences by group, which the program wrote.
"use strict";

/** The result of a comparison of two files, which the program wrote, too. */
tandem.againstText = differences => `${differences.new} against ${differences.old}: ${differences.summary}`;

tandem.summary = (data, differences) => {
  const {element} = tandem;
  const paragraphs = [...(differences ? [tandem.againstText(differences)] : []), ...data.words].map(text => element("p", {class: "lead"}, text));
  const notes = data.notes.map(text => element("p", {class: "bad"}, "Left out: " + text + "."));
  const groupItem = group => element("li", {}, element("strong", {}, group.title + ": "), group.words);
  // Groups with a comparison or an error come first.
  const isInformative = group => group.ranked.length > 1 || group.cells.some(cell => cell.status !== "ok");
  const groups = [...data.groups.filter(isInformative), ...data.groups.filter(group => !isInformative(group))];
  const shown = 10;
  const lists = [element("ul", {}, ...groups.slice(0, shown).map(groupItem))];
  if (groups.length > shown) {
    // Filled only when it is opened, so that a page of many groups loads faster.
    const rest = element("details", {ontoggle: () => {
      if (rest.open && rest.children.length === 1) rest.append(element("ul", {}, ...groups.slice(shown).map(groupItem)));
    }}, element("summary", {}, `${groups.length - shown} more comparisons`));
    lists.push(rest);
  }
  const how = element("p", {class: "quiet"}, "Comparisons are between cells of one scene, frame range, devices, bounds and output. Brackets are 95 % " +
    "intervals, each of one comparison. Two cells are not told apart if the interval of their ratio contains 1.");
  if (data.groups.length) tandem.show("summary", ...notes, ...paragraphs, ...lists, how);
  else tandem.show("summary", ...notes, element("p", {}, "There are no cells in these files."));
};

tandem.ceilings = data => {
  if (!data.ceilings.length) return;
  const names = [...new Set(data.ceilings.flatMap(entry => Object.keys(entry.values || {})))];
  const conditions = [...new Set(data.ceilings.flatMap(entry => Object.keys(entry.conditions)))];
  tandem.show("others", tandem.table("Ceilings of each device: medians of its measurements, and their conditions",
    ["measured", ...data.ceilings.map(entry => entry.device)],
    [...names.map(name => [name.replace(/_/g, " "), ...data.ceilings.map(entry => entry.values?.[name] ?? "not known")]),
      ...conditions.map(name => [name, ...data.ceilings.map(entry => entry.conditions[name])])]));
};
