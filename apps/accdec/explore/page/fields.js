// Inputs for a value of a task, by the type of its key.
import { make } from "./format.js";
import { firstValue, neededBy } from "./keys.js";
import { markUnread, slider } from "./slider.js";

/**
 * @param state   the task
 * @param put     called with a new value
 * @param table   the table of the key, or undefined
 * @param updates what shows a new value of the task in a field is added here
 */
export function field(key, path, { id, state, put, table, updates }) {
  const now = () => state.get(path);
  if (key.type === "number" || key.type === "integer") {
    const { element, update } = slider(key, id, now, put);
    updates.push(update);
    return element;
  }
  if (key.type === "boolean") {
    const box = make("input", { type: "checkbox", id, checked: now() });
    box.addEventListener("change", () => put(box.checked));
    return box;
  }
  if (key.type === "words") {
    const chosen = [now()].flat();
    return make(
      "span",
      { class: "words", id },
      ...key.words.map((word) => {
        const box = make("input", { type: "checkbox", checked: chosen.includes(word) });
        // At least one of them.
        box.addEventListener("change", () => {
          const words = key.words.filter((other) => (other === word ? box.checked : [now()].flat().includes(other)));
          if (words.length) put(words);
          else box.checked = true;
        });
        return make("label", {}, box, ` ${word}`);
      }),
    );
  }
  if (key.type === "word") {
    const choice = make("select", { id }, ...key.words.map((word) => make("option", {}, word)));
    choice.value = now();
    choice.addEventListener("change", () => {
      if (!table || !neededBy(table, { kind: key.words[0] }).length) return put(choice.value);
      // Another kind of filter has other keys.
      const value = { kind: choice.value };
      const old = state.get(path.slice(0, -1));
      for (const name of neededBy(table, value))
        value[name] = old[name] ?? firstValue(table.keys.find((k) => k.name === name));
      state.set([[path.slice(0, -1), value]], null, true);
    });
    return choice;
  }
  const text = make("input", { type: "text", id, value: key.type === "text" ? now() : JSON.stringify(now()) });
  if (key.type === "text") text.addEventListener("change", () => put(text.value));
  else onList(text, put);
  return text;
}

function listOf(text) {
  try {
    return JSON.parse(text);
  } catch {
    return undefined;
  }
}

/** While a field holds no list, the answer on the page is not about what it shows; leaving the field says so. */
function onList(field, put) {
  field.addEventListener("input", () => {
    const list = listOf(field.value);
    field.setCustomValidity(list === undefined ? "a list of numbers in brackets" : "");
    field.classList.toggle("wrong", list === undefined);
    markUnread();
    if (list !== undefined) put(list);
  });
  field.addEventListener("change", () => field.reportValidity());
}
