// What leaves the page: the task, the design in every format of `export`, the page itself.
import { make } from "./format.js";
import { askBlob, askText } from "./requests.js";

function download(blob, name) {
  const link = make("a", { href: URL.createObjectURL(blob), download: name });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}

const baseName = ({ state }) =>
  (state.task.title || "task")
    .replace(/[^\w.-]+/g, "-")
    .replace(/^-+|-+$/g, "")
    .slice(0, 60) || "task";

export async function copyTask(shared) {
  try {
    const text = await askText("file", shared.state.task);
    try {
      await navigator.clipboard.writeText(text);
      shared.note("copied");
    } catch {
      download(new Blob([text], { type: "text/plain" }), `${baseName(shared)}.toml`);
      shared.note("saved as a file: the browser keeps the clipboard to itself");
    }
  } catch (error) {
    shared.note(error.message);
  }
}

const endings = { csv: "csv", c: "h", json: "json", npy: "npy", cascade: "json" };

export function exportChoice(select, shared) {
  const choices = [
    ["task", "task file"],
    ["result", "result, with its proof"],
    ...shared.start.formats.map((f) => [f, `taps, ${f}`]),
  ];
  select.append(
    make("option", { value: "" }, "choose .."),
    ...choices.map(([value, text]) => make("option", { value }, text)),
  );
  select.addEventListener("change", async () => {
    const format = select.value;
    select.value = "";
    try {
      const name = baseName(shared);
      if (format === "task") return download(await askBlob("file", shared.state.task), `${name}.toml`);
      const body = format === "result" ? shared.state.task : shared.page.design?.result;
      if (!body) throw new Error("there is no design to export");
      const blob = await askBlob("export", body, { format, seconds: 20, slot: format });
      download(blob, `${name}${format === "result" ? "-result.json" : `-${format}.${endings[format] ?? format}`}`);
    } catch (error) {
      shared.note(error.message);
    }
  });
}

/** The present state as one file: drawings as images, no script, nothing linked. */
export async function pageText(shared) {
  const copy = document.documentElement.cloneNode(true);
  const drawn = document.querySelectorAll("canvas");
  copy.querySelectorAll("canvas").forEach((canvas, i) => {
    const image = make("img", {
      src: drawn[i].toDataURL(),
      alt: "",
      style: `width:${drawn[i].style.width};height:${drawn[i].style.height}`,
    });
    canvas.replaceWith(image);
  });
  copy
    .querySelectorAll("script, link, #tools, button.add, button.drop, select.more, .group .tools, input[type=range]")
    .forEach((e) => e.remove());
  const fields = document.querySelectorAll("#controls input:not([type=range]), #controls select:not(.more)");
  copy
    .querySelectorAll("#controls input, #controls select")
    .forEach((field, i) =>
      field.replaceWith(
        make("output", {}, fields[i].type === "checkbox" ? (fields[i].checked ? "yes" : "no") : fields[i].value),
      ),
    );
  copy.querySelectorAll("button").forEach((button) => button.replaceWith(make("span", {}, button.textContent)));
  for (const name of ["uPlot.min.css", "style.css"])
    copy.querySelector("head").append(make("style", {}, await (await fetch(name)).text()));
  const task = await askText("file", shared.state.task);
  copy
    .querySelector("main")
    .append(
      make("details", { id: "task-file" }, make("summary", {}, "The task, as a task file"), make("pre", {}, task)),
    );
  return `<!doctype html>\n${copy.outerHTML}\n`;
}

export async function savePage(shared) {
  try {
    download(new Blob([await pageText(shared)], { type: "text/html" }), `${baseName(shared)}.html`);
  } catch (error) {
    shared.note(error.message);
  }
}
