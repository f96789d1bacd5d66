// Everything that leaves the page: the task, the design in every format of `export`, the page itself.
import { make } from "./format.js";
import { about, askBlob, askText } from "./requests.js";

export function download(blob, name) {
  const link = make("a", { href: URL.createObjectURL(blob), download: name });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}

/** What a file is called after a name; "task" if nothing of the name can stand there. */
export const baseName = (name) =>
  name
    .replace(/[^\w.-]+/g, "-")
    .replace(/^-+|-+$/g, "")
    .slice(0, 60) || "task";
const taskName = ({ state }) => baseName(state.task.title ?? "");

const no_number = "not saved: a field has no number that is allowed";
const has = (name) => document.body.classList.contains(name);
const unread = () => has("unread");

export async function copyTask(shared) {
  try {
    const text = await askText("file", shared.state.task);
    try {
      await navigator.clipboard.writeText(text);
      shared.note("copied");
    } catch {
      download(new Blob([text], { type: "text/plain" }), `${taskName(shared)}.toml`);
      shared.note("saved as a file: the browser keeps the clipboard to itself");
    }
  } catch (error) {
    shared.note(error.message);
  }
}

const endings = { c: "h", cascade: "json", klipper: "cfg", q15: "h", q31: "h" };
/** A file's name; that of a component of LinuxCNC is the component's. */
export function fileName(name, format) {
  if (format === "task") return `${name}.toml`;
  if (format === "result") return `${name}-result.json`;
  if (format === "linuxcnc-comp") return "accdec_filter.comp";
  const ending = endings[format] ?? format;
  return ending === format ? `${name}.${ending}` : `${name}-${format}.${ending}`;
}

/** A menu of formats, and the button that exports: arrow keys go through the choices of a closed menu. */
export function exportChoice(select, button, shared) {
  const choices = [
    ["task", "task file"],
    ["result", "result, with its proof"],
    ...shared.start.formats.map((f) => [f, `taps, ${f}`]),
  ];
  select.append(...choices.map(([value, text]) => make("option", { value }, text)));
  const savings = new Map(choices.map(([format]) => [format, new Saving()]));
  const exported = async (format, wait) => {
    if (unread()) throw new Error(no_number);
    if (format === "task") return askBlob("file", shared.state.task);
    const how = { format, seconds: 20, slot: format };
    await answered(shared, wait); // of what is on the page
    const { design } = shared.page;
    if (format !== "result" && !design?.result.filter) throw new Error("there is no design to export");
    // The page has no proof: a result that nobody holds is found again.
    if (format === "result" && !design?.held) return askBlob("export", shared.state.task, { ...how, whole: true });
    return askBlob("export", ...about(design, how));
  };
  button.addEventListener("click", () => {
    const format = select.value;
    savings.get(format).save((wait) => exported(format, wait), fileName(taskName(shared), format), shared.note);
  });
}

/** Says in words which buttons were pressed: a saved page has no buttons. */
function sayChoices(copy) {
  const chosen = copy.querySelector("#corners:not([hidden]) [aria-pressed=true]");
  if (chosen) {
    const names = [...chosen.parentElement.children].map((button) => button.textContent);
    const shown = make("b", {}, chosen.textContent);
    chosen.parentElement.replaceChildren("Corner shown: ", shown, ` (of ${names.join(", ")})`);
  }
  for (const group of copy.querySelectorAll("#plans, #colour-by")) {
    const others = [...group.querySelectorAll("[aria-pressed=false]")];
    const shown = group.querySelector("[aria-pressed=true]");
    if (group.id === "colour-by") others.forEach((button) => button.remove());
    else if (others.length)
      group.append(make("span", {}, ` (other plans: ${others.map((b) => b.textContent).join("; ")})`));
    others.forEach((button) => button.remove());
    if (shown && group.id === "plans") shown.replaceWith(make("b", {}, shown.textContent));
    else shown?.remove();
  }
  const told = copy.querySelector("#limits");
  if (told && !told.querySelector(".wide").textContent) told.remove();
  copy.querySelectorAll("button").forEach((button) => {
    const name = make(button.getAttribute("aria-pressed") === "true" ? "b" : "span", {}, button.textContent);
    button.replaceWith(name);
  });
}

/** A copy of the page as one file: drawings as images, no script, nothing linked. @param change  gets the copy */
export async function frozen(change = () => {}) {
  const copy = document.documentElement.cloneNode(true);
  const drawn = document.querySelectorAll("canvas");
  copy.querySelectorAll("canvas").forEach((canvas, i) => {
    const image = make("img", { src: drawn[i].toDataURL(), alt: "" });
    const { width, height } = drawn[i].style;
    Object.assign(image.style, { width, height }); // an attribute would break the page's rules for its content
    canvas.replaceWith(image);
  });
  copy
    .querySelectorAll(
      "script, link, #tools, .hint, #corner .tools, .range label, #explain, button.add, button.drop, .more, " +
        ".group .tools, input[type=range]",
    )
    .forEach((e) => e.remove());
  const wanted = [...copy.querySelectorAll("[tabindex]")];
  wanted.forEach((e) => e.removeAttribute("tabindex"));
  const fields = document.querySelectorAll("#controls input:not([type=range]), #controls select:not(.more)");
  copy
    .querySelectorAll("#controls input, #controls select")
    .forEach((field, i) =>
      field.replaceWith(
        make("output", {}, fields[i].type === "checkbox" ? (fields[i].checked ? "yes" : "no") : fields[i].value),
      ),
    );
  copy.querySelectorAll("tr.old").forEach((row) => row.remove());
  copy.querySelectorAll(".wide.old, .wide.running").forEach((place) => place.replaceChildren());
  sayChoices(copy);
  for (const name of ["uPlot.min.css", "style.css"])
    copy.querySelector("head").append(make("style", {}, await (await fetch(name)).text()));
  copy.querySelector("body").classList.add("saved");
  await change(copy);
  return `<!doctype html>\n${copy.outerHTML}\n`;
}

const longest = 90; // s: questions have up to 60 s

/**
 * Waits for what is still being computed, so that what is saved speaks of one task.
 * @throws Error where there is no answer to what the fields say
 * @param wait  {tell(what): called with what is waited for; ends(): true to wait no longer}
 */
async function answered(shared, wait) {
  const began = performance.now();
  const seconds = () => (performance.now() - began) / 1e3;
  const awaited = () => {
    const names = unread() ? [] : shared.awaited();
    return names.length || unread() || !has("stale") ? names : ["the design"];
  };
  for (let names; (names = awaited()).length && seconds() < longest && !wait.ends?.(); ) {
    wait.tell?.(`waiting for ${names.join(", ")}: ${seconds().toFixed(0)} s`);
    await new Promise((go) => setTimeout(go, 50));
  }
  if (unread()) throw new Error(no_number);
  if (has("stale")) throw new Error("not saved: these numbers have no answer yet; save when it is there");
}

/** The present state, with its task. @throws Error where there is no answer @param wait  see answered */
export async function pageText(shared, wait = {}) {
  await answered(shared, wait);
  const task = askText("file", shared.state.task);
  const summary = make("summary", {}, "The task, as a task file");
  return frozen(async (copy) =>
    copy.querySelector("main").append(make("details", { id: "task-file" }, summary, make("pre", {}, await task))),
  );
}

/**
 * Saves a file as soon as it is complete; asked once more meanwhile, it waits no longer.
 * @param content  gives a text or a blob, see pageText  @param tell  called with (text, lasting)
 */
export class Saving {
  async save(content, name, tell) {
    if (this.running) return void (this.ended = true);
    Object.assign(this, { running: true, ended: false });
    tell("");
    try {
      const said = (what) => tell(`${what}; press again to end that`, true);
      const found = await content({ tell: said, ends: () => this.ended });
      download(found instanceof Blob ? found : new Blob([found], { type: "text/html" }), name);
      tell("");
    } catch (error) {
      tell(error.message);
    }
    this.running = false;
  }
}
const saving = new Saving();
export const savePage = (shared) => saving.save(shared.pageText, `${taskName(shared)}.html`, shared.note);
