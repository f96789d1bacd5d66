// The task on the page: its history, and its copy in the address.

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

export class State {
  /** changed(structure): called after every change; `structure` where keys came or went, not only values. */
  constructor(task, changed) {
    this.first = clone(task);
    this.changed = changed;
    this.past = [];
    this.future = [];
    this.task = this.fromAddress() ?? clone(task);
    addEventListener("hashchange", () => {
      const task = this.fromAddress();
      if (task && JSON.stringify(task) !== JSON.stringify(this.task)) this.replace(task);
    });
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
    if (!(name && name === this.last && now - this.when < 1000)) this.past.push(clone(this.task));
    if (this.past.length > 500) this.past.shift();
    this.last = name;
    this.when = now;
    this.future = [];
    apply(this.task, changes);
    this.tell(structure);
  }

  replace(task) {
    this.past.push(clone(this.task));
    this.future = [];
    this.task = clone(task);
    this.last = null;
    this.tell(true);
  }

  undo() {
    this.move(this.past, this.future);
  }
  redo() {
    this.move(this.future, this.past);
  }
  move(from, to) {
    if (!from.length) return;
    to.push(clone(this.task));
    this.task = from.pop();
    this.last = null;
    this.tell(true);
  }
  reset() {
    this.replace(this.first);
  }

  tell(structure) {
    clearTimeout(this.writing);
    this.writing = setTimeout(() => this.toAddress(), 200);
    this.changed(structure);
  }
  toAddress() {
    const same = JSON.stringify(this.task) === JSON.stringify(this.first);
    history.replaceState(null, "", same ? location.pathname : taskAddress(this.task));
  }
  /** The task that the address holds, or null; `broken` says that it should hold one. */
  fromAddress() {
    this.broken = false;
    if (!location.hash.startsWith("#task=")) return null;
    try {
      const task = JSON.parse(fromBase64(location.hash.slice(6)));
      const isTable = (value) => value?.constructor === Object;
      const lists = ["axis", "corner", "mode"].map((name) => task[name] ?? []);
      if (isTable(task) && lists.every((list) => Array.isArray(list) && list.every(isTable))) return task;
    } catch {
      // told by `broken`
    }
    this.broken = true;
    return null;
  }
}
