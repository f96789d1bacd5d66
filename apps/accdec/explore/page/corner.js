// A corner of the program as a task of its own: the explorer's page, above the program.
import { $, make } from "./format.js";

/** In place of the corner that was open. @param address  of its page; none: no corner is open */
export function openCorner(title, address) {
  const place = $("#corner");
  place.hidden = !address;
  // A new frame: another address of the same one would be a step of the browser's own way back.
  place.querySelector("div").replaceChildren(...(address ? [make("iframe", { src: address, title })] : []));
  place.querySelector("h2").textContent = title;
  place.querySelector("a").href = address ?? "";
}

/** The open corner as one file, or null. @param wait  see pageText of save.js */
export const cornerText = (wait) => $("#corner iframe")?.contentWindow.accdecPage?.pageText(wait) ?? null;
