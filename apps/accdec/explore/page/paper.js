// The page on paper, which can be neither unfolded nor moved sideways.
import { $, make } from "./format.js";
import { tapTable } from "./tables.js";

const most_taps = 500; // of a table on paper
// Where a pair of drawings is on one row: behind the controls, or without them in a narrow window.
const two_columns = "(min-width: 76rem), (min-width: 50rem) and (max-width: 1000px)";

/** What is folded is open while the page is printed, and texts that are longer than their fields are whole. */
export function printing(shared) {
  let undo = [];
  addEventListener("beforeprint", () => {
    // The media query of the screen for two drawings beside each other, which paper cannot ask.
    document.body.classList.toggle("columns", matchMedia(two_columns).matches);
    const { filter } = shared.page.design?.result ?? {};
    const few = filter && filter.taps.length <= most_taps;
    if (few) $("#tap-table .wide").replaceChildren(tapTable(shared.page.design.result));
    for (const part of document.querySelectorAll(`details:not([open])${few ? "" : ":not(#tap-table)"}`)) {
      part.open = true;
      // The page may have replaced a part with a name meanwhile.
      undo.push(() => ((document.getElementById(part.id) ?? part).open = false));
    }
    for (const field of document.querySelectorAll("#controls input[type=text]")) {
      const text = make("output", {}, field.value);
      field.after(text);
      undo.push(() => text.remove());
    }
  });
  addEventListener("afterprint", () => {
    for (const one of undo) one();
    undo = [];
  });
}
