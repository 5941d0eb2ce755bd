// SPDX-License-Identifier: MIT
// For pages with groups that fold (groups.py): the links to groups become buttons that choose which group is shown.
"use strict";
for (const bar of document.querySelectorAll(".groups")) {
  const links = [...bar.querySelectorAll("a")];
  const groups = links.map(link => document.querySelector(link.hash).closest("details"));
  const buttons = links.map((link, i) => {
    const button = document.createElement("button");
    button.type = "button";
    button.textContent = link.textContent;
    button.onclick = () => show(groups[i]);
    link.replaceWith(button);
    return button;
  });
  /** Shows and opens one group; null shows all as they are. */
  const show = chosen => groups.forEach((group, i) => {
    buttons[i].setAttribute("aria-pressed", group === chosen);
    if (group === null) return;
    group.hidden = chosen !== null && group !== chosen;
    group.open ||= group === chosen;
  });
  show(null);
  // A link to something in a group that is not shown.
  addEventListener("hashchange", () => {
    const target = document.getElementById(decodeURIComponent(location.hash.slice(1)));
    if (!target?.closest("details[hidden]")) return;
    show(null);
    target.scrollIntoView();
  });
}
document.documentElement.dataset.ready = "true";
