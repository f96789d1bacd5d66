// The buttons of the page.
import { $, make } from "./format.js";
import { undoByKeys } from "./history.js";
import { printing } from "./paper.js";
import { askJson } from "./requests.js";
import { copyTask, exportChoice, savePage } from "./save.js";
import { explanationTable } from "./tables.js";

/** Keys go through the choices of a closed menu, and Enter or leaving it chooses. An open menu says by itself which. */
function onChoice(select, choose) {
  let walking = false;
  const chosen = () => {
    if (walking) choose(select.value);
    walking = false;
  };
  select.addEventListener("keydown", (event) => {
    if (event.key === "Enter" && walking) event.preventDefault(), chosen(); // else it opens the menu
    const walks = /^(Arrow|Page|Home$|End$)/.test(event.key) || (event.key.length === 1 && event.key !== " ");
    walking ||= walks && !event.altKey;
  });
  select.addEventListener("pointerdown", chosen);
  select.addEventListener("blur", chosen);
  select.addEventListener("change", () => walking || choose(select.value));
}

export function tools(shared, draw) {
  const { start, state } = shared;
  $("#undo").onclick = () => state.undo();
  $("#redo").onclick = () => state.redo();
  $("#reset").onclick = () => state.reset();
  $("#copy").onclick = () => copyTask(shared);
  $("#save").onclick = () => savePage(shared);
  exportChoice($("#export"), $("#download"), shared);
  $("#whole").onchange = (event) => state.choose({ whole: event.target.checked });
  $("#tap-table").ontoggle = draw;
  const changed = make("option", { value: "changed", hidden: true, disabled: true }, "changed");
  $("#shipped").append(
    make("option", { value: "", title: start.name }, start.name.replace(/^.*[/]/, "") || "choose .."),
    ...start.shipped.map((s) => make("option", {}, s.name)),
    changed,
  );
  const known = new Map([...start.shipped].reverse().map((s) => [JSON.stringify(s.task), s.name]));
  known.set(JSON.stringify(start.task), "");
  /** The menu names the task that is shown. */
  shared.named = () => ($("#shipped").value = known.get(JSON.stringify(state.task)) ?? "changed");
  shared.named();
  onChoice($("#shipped"), (name) => {
    if (name !== "changed") state.replace(start.shipped.find((s) => s.name === name)?.task ?? start.task);
  });
  $("#explain").onclick = async () => {
    const button = $("#explain"),
      place = $("#limits .wide");
    if (place.classList.contains("running")) return;
    button.setAttribute("aria-disabled", "true"); // disabled, it would lose the focus
    place.classList.add("running");
    const asked = structuredClone(state.task);
    place.replaceChildren("solving the task again with more room for every limit ..");
    try {
      place.replaceChildren(...explanationTable(await askJson("explain", asked, { seconds: 60 })));
      place.dataset.task = JSON.stringify(asked);
      place.classList.toggle("old", place.dataset.task !== document.body.dataset.task);
    } catch (error) {
      place.replaceChildren(error.message);
    }
    button.removeAttribute("aria-disabled");
    place.classList.remove("running");
  };
  printing(shared);
  undoByKeys(state);
}
