// The task on the page and what is chosen to be shown of it: their history, and their copy in the address.
import { History } from "./history.js";

const clone = (value) => JSON.parse(JSON.stringify(value));

function toBase64(text) {
  const bytes = new TextEncoder().encode(text);
  let plain = "";
  for (const byte of bytes) plain += String.fromCharCode(byte);
  return btoa(plain).replaceAll("+", "-").replaceAll("/", "_").replaceAll("=", "");
}

function fromBase64(text) {
  const plain = atob(text.replaceAll("-", "+").replaceAll("_", "/"));
  return new TextDecoder().decode(Uint8Array.from(plain, (c) => c.charCodeAt(0)));
}

/** The end of an address whose page begins with this task. */
export const taskAddress = (task) => `#task=${toBase64(JSON.stringify(task))}`;

/** Other values at paths; undefined removes. */
function apply(task, changes) {
  for (const [path, value] of changes) {
    const place = path.slice(0, -1).reduce((node, step) => (node[step] ??= {}), task);
    const key = path.at(-1);
    if (value === undefined && Array.isArray(place)) place.splice(key, 1);
    else if (value === undefined) delete place[key];
    else place[key] = value;
  }
  return task;
}

/** The choices beside the task, as they stand in the address. */
const kinds = { corner: "number", beside: "string", whole: "boolean", planned: "boolean" };
const isTable = (value) => value?.constructor === Object;
const isTask = (task) =>
  isTable(task) && ["axis", "corner", "mode"].every((name) => [task[name] ?? []].flat().every(isTable));

/** A whole number from 0 on; 0 for what is none. */
function numberOf(text) {
  const number = Math.floor(Number(text));
  return Number.isSafeInteger(number) && number > 0 ? number : 0;
}

function choicesOf(words) {
  const choices = {};
  for (const [name, kind] of Object.entries(kinds)) {
    if (!words.has(name)) continue;
    const text = words.get(name);
    choices[name] = kind === "number" ? numberOf(text) : kind === "boolean" ? text === "true" : text;
  }
  return choices;
}

export class State {
  /**
   * changed(structure): called after every change of the task; `structure` where keys came or went, not only values.
   * chosen(): called where other things of the same task are shown.
   */
  constructor(task, changed, chosen) {
    Object.assign(this, { first: clone(task), changed, chosen, history: new History() });
    Object.assign(this, this.fromAddress() ?? { task: clone(task), choices: {} });
    addEventListener("hashchange", () => {
      const found = this.fromAddress();
      if (found && JSON.stringify(found) !== JSON.stringify(this.now())) this.replace(found.task, found.choices);
    });
  }

  now() {
    return clone({ task: this.task, choices: this.choices });
  }
  get(path) {
    return path.reduce((value, step) => value?.[step], this.task);
  }

  /** The task as it would be with these changes. */
  with(changes) {
    return apply(clone(this.task), changes);
  }

  /** Sets values at paths; undefined removes. Changes of one name within a second are undone together. */
  set(changes, name, structure = false) {
    const now = Date.now();
    if (!(name && name === this.last && now - this.when < 1000)) this.history.leave(this.now());
    this.last = name;
    this.when = now;
    apply(this.task, changes);
    this.tell(structure);
  }

  /** Chooses what is shown of the task: {corner, beside, whole}, as far as it changes. */
  choose(choices) {
    this.put({ task: this.task, choices: { ...this.choices, ...choices } });
  }
  replace(task, choices = {}) {
    this.put({ task, choices });
  }
  put(next) {
    if (JSON.stringify(next) === JSON.stringify(this.now())) return;
    this.history.leave(this.now());
    this.show(next);
  }

  undo() {
    this.show(this.history.undo(this.now()));
  }
  redo() {
    this.show(this.history.redo(this.now()));
  }
  reset() {
    this.replace(this.first);
  }

  show(next) {
    if (!next) return;
    const same = JSON.stringify(next.task) === JSON.stringify(this.task);
    Object.assign(this, clone(next), { last: null });
    this.tell(true, same);
  }
  tell(structure, same = false) {
    clearTimeout(this.writing);
    this.writing = setTimeout(() => this.toAddress(), 200);
    if (same) this.chosen();
    else this.changed(structure);
  }
  toAddress() {
    const words = Object.entries(this.choices).map(([name, value]) => `${name}=${encodeURIComponent(value)}`);
    const own = JSON.stringify(this.task) !== JSON.stringify(this.first);
    if (own) words.unshift(taskAddress(this.task).slice(1));
    history.replaceState(null, "", words.length ? `#${words.join("&")}` : location.pathname);
  }
  /** The task and the choices that the address holds, or null; `broken` says that it should hold a task. */
  fromAddress() {
    this.broken = false;
    if (location.hash.length < 2) return null;
    const words = new URLSearchParams(location.hash.slice(1));
    const choices = choicesOf(words);
    if (!words.has("task")) return { task: clone(this.first), choices };
    try {
      const task = JSON.parse(fromBase64(words.get("task")));
      if (isTask(task)) return { task, choices };
    } catch {
      // told by `broken`
    }
    this.broken = true;
    return null;
  }
}
