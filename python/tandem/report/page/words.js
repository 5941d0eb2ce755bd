// SPDX-License-Identifier: MIT
// The summary: sentences that the program made, by group.
"use strict";

tandem.summary = data => {
  const {element} = tandem;
  const paragraphs = data.words.map(text => element("p", {class: "lead"}, text));
  const notes = data.notes.map(text => element("p", {class: "bad"}, "Left out: " + text + "."));
  const groupItem = group => element("li", {}, element("strong", {}, group.title + ": "), group.words);
  // Those that compare anything first.
  const says = group => group.ranked.length > 1 || group.cells.some(cell => cell.status !== "ok");
  const groups = [...data.groups.filter(says), ...data.groups.filter(group => !says(group))];
  const most = 10;
  const lists = [element("ul", {}, ...groups.slice(0, most).map(groupItem))];
  if (groups.length > most) {
    // Filled when it is opened: a page of many groups opens faster.
    const rest = element("details", {ontoggle: () => {
      if (rest.open && rest.children.length === 1) rest.append(element("ul", {}, ...groups.slice(most).map(groupItem)));
    }}, element("summary", {}, `${groups.length - most} more comparisons`));
    lists.push(rest);
  }
  const how = element("p", {class: "quiet"}, "Compared are cells of one scene, frames, devices, bounds and output. Brackets are 95 % " +
    "intervals, of one comparison each; two are not told apart where 1 lies in the interval of their ratio.");
  if (data.groups.length) tandem.show("summary", ...notes, ...paragraphs, ...lists, how);
  else tandem.show("summary", ...notes, element("p", {}, "There are no cells in these files."));
};

tandem.ceilings = data => {
  if (!data.ceilings.length) return;
  const names = [...new Set(data.ceilings.flatMap(entry => Object.keys(entry.values || {})))];
  tandem.show("others", tandem.table("What each device can do at most: medians of its measurements",
    ["measured", ...data.ceilings.map(entry => entry.device)],
    names.map(name => [name.replace(/_/g, " "), ...data.ceilings.map(entry => entry.values[name] ?? "not known")])));
};
