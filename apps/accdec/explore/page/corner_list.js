// The corners of a program, the sharpest first: each can be opened by keys, too.
import { $, four, make, table } from "./format.js";

const shown_first = 20;

/**
 * @param addressOf  the address that a corner opens
 * @param feedsOf    its feeds as a text
 * @param open       called with its number in the program
 */
export function cornerList(program, { addressOf, feedsOf, open }, count = shown_first) {
  const all = program.corners.length,
    place = $("#corner-list");
  if (!all) return place.replaceChildren(make("p", {}, "The program turns nowhere: there is no corner to open."));
  const link = (c) => {
    const onclick = (event) => {
      if (event.ctrlKey || event.metaKey || event.shiftKey) return; // in a window of its own
      event.preventDefault();
      open(program.corners.indexOf(c));
    };
    return make("a", { href: addressOf(c), target: "_blank", onclick }, `line ${c.line}`);
  };
  const sharp = [...program.corners].sort((a, b) => a.angle_deg - b.angle_deg).slice(0, count);
  const rows = sharp.map((c) => [
    link(c),
    c.at_mm.map(four).join(", "),
    four(c.angle_deg),
    feedsOf(c),
    c.corner.error_max_um === undefined ? "\u2013" : four(c.corner.error_max_um),
  ]);
  const feeds = program.corners.some((c) => c.planned) ? "feeds of plan fixed" : "feeds";
  const place_mm = `${program.axes.join(", ")} / mm`;
  const head = ["corner", place_mm, "angle / \u00b0", `${feeds} / mm/min`, "tolerance / \u00b5m"];
  const which = all > count ? `the sharpest ${count} of ${all} corners` : all > 1 ? `${all} corners` : "the corner";
  const more = () => {
    cornerList(program, { addressOf, feedsOf, open }, all);
    place.querySelectorAll("a")[count].focus();
  };
  place.replaceChildren(
    make("h2", {}, which, make("span", { class: "hint" }, ": open one to design it by itself")),
    make("div", { class: "wide" }, table(head, rows, { right: [3] })),
    ...(all > count ? [make("button", { type: "button", class: "hint", onclick: more }, `show all ${all}`)] : []),
  );
}
