// A control for every key of a task, made from the table of keys that the program checks files with.
import { make, unit } from "./format.js";
import { field } from "./fields.js";
import { markUnread } from "./slider.js";
import { alongWith, barredBy, firstTable, firstValue, isBand, isNeeded, otherWay, shares, shortName } from "./keys.js";

// In a narrow window all groups are folded at first, as the answer stands below them.
const narrow = globalThis.matchMedia?.("(max-width: 1000px)").matches ?? false;

export class Controls {
  /** refusals(tasks): a promise of why each cannot be designed, or null. */
  constructor(form, keys, state, refusals) {
    Object.assign(this, { form, keys, state, refusals, apart: false, open: new Map() });
    form.addEventListener("submit", (event) => event.preventDefault());
    this.build();
  }

  build() {
    const focused = this.form.contains(document.activeElement) ? document.activeElement : null;
    const group = focused?.closest("details")?.querySelector("summary").id;
    this.updates = [];
    this.offers = [];
    this.form.replaceChildren();
    const general = this.keys.filter((key) => !key.keys);
    this.form.append(
      this.group(
        "Task",
        general.flatMap((key) => this.row(key, [[key.name]])),
        "task",
      ),
    );
    for (const key of this.keys) {
      if (key.type === "tables") this.list(key);
      else if (key.type === "table") this.table(key);
    }
    // A control that is gone leaves the focus to its group, or to the button that brings it back.
    const heirs = focused ? [focused.id, group, focused.dataset.heir].filter(Boolean) : [];
    heirs.map((id) => document.getElementById(id)).find((one) => one?.getClientRects().length)?.focus();
    markUnread();
    this.checkSoon();
  }

  /** New values in the controls that are there. */
  update() {
    for (const update of this.updates) update();
    this.checkSoon();
  }

  checkSoon() {
    clearTimeout(this.checking);
    this.checking = setTimeout(() => this.check(), 500);
  }
  /**
   * Keys that the task cannot have as it is, or cannot be without, are offered in grey, with the reason. Of a task that
   * is refused already all can be removed.
   */
  async check() {
    const { offers } = this;
    const tasks = [[], ...offers.map(({ changes }) => changes)].map((changes) => this.state.with(changes));
    if (!offers.length || JSON.stringify(tasks).length > 5e5) return;
    const [now, ...reasons] = (await this.refusals(tasks)) ?? [];
    offers.forEach(({ option, meaning, removes }, i) => {
      const reason = removes && now ? null : reasons[i];
      option.disabled = Boolean(reason);
      option.title = reason?.replaceAll("task: ", "") ?? meaning;
    });
  }

  group(title, rows, name, tools = []) {
    const open = this.open.get(name) ?? !(narrow || ["task", "design", "filter", "program"].includes(name));
    const element = make(
      "details",
      { open, class: "group" },
      make("summary", { id: `group-${name}` }, title),
      ...rows.filter(Boolean),
      make("div", { class: "tools" }, ...tools),
    );
    element.addEventListener("toggle", () => this.open.set(name, element.open));
    return element;
  }

  table(key) {
    const value = this.state.get([key.name]);
    if (value === undefined) {
      this.addButton(key, () => firstValue(key));
      return;
    }
    const remove = this.removal(key, [key.name]);
    this.form.append(this.group(key.name, this.rows(key, [[key.name]]), key.name, key.required ? [] : [remove]));
  }

  list(key) {
    const all = this.state.get([key.name]) ?? [];
    const alike =
      key.name === "axis" &&
      all.length > 1 &&
      !this.apart &&
      new Set(all.map((one) => JSON.stringify({ ...one, name: "" }))).size === 1;
    const groups = alike ? [all.map((_, i) => [key.name, i])] : all.map((_, i) => [[key.name, i]]);
    for (const paths of groups) {
      const names = paths.map((path) => this.state.get(path).name ?? path[1] + 1);
      const tools = [];
      if (alike)
        tools.push(
          make("button", { type: "button", onclick: () => ((this.apart = true), this.build()) }, "set them apart"),
        );
      else if (key.name !== "axis" && (key.name !== "corner" || all.length > 1))
        tools.push(this.removal(key, paths[0]));
      this.form.append(
        this.group(
          `${key.name} ${names.join(", ")}`,
          this.rows(key, paths, alike ? ["name"] : []),
          `${key.name}${paths[0][1]}`,
          tools,
        ),
      );
    }
    if (key.name === "axis") return;
    this.addButton(key, () => [...all, this.another(key, all)]);
  }

  /** A button that gives the task a table, or one more of a list. */
  addButton(key, value) {
    const onclick = () => this.state.set([[[key.name], value()]], null, true);
    const names = { id: `add-${key.name}`, "data-heir": `group-${key.name}`, title: key.meaning };
    this.form.append(make("button", { type: "button", class: "add", ...names, onclick }, `+ ${key.name}`));
  }

  /** One more of a list: as the last, under a name that is free. */
  another(key, all) {
    const value = all.length ? JSON.parse(JSON.stringify(all.at(-1))) : firstTable(key);
    if (value.name === undefined) return value;
    for (let i = all.length; ; ++i) {
      const name = i < 26 ? String.fromCharCode(65 + i) : `C${i + 1}`;
      if (!all.some((one) => one.name === name)) return { ...value, name };
    }
  }

  removal(key, path) {
    const onclick = () => this.state.set([[path, undefined]], null, true);
    const attributes = { type: "button", id: `remove-${path.join("-")}`, "data-heir": `add-${key.name}`, onclick };
    return make("button", attributes, `remove ${key.name}`);
  }

  /** Rows for the keys that a table has, and a choice of those that it may get. */
  rows(key, paths, hidden = []) {
    const value = this.state.get(paths[0]);
    const barred = barredBy(key, value);
    const rows = [],
      absent = [];
    for (const inner of key.keys) {
      if (hidden.includes(inner.name) || (barred.has(inner.name) && !otherWay(key, inner))) continue;
      if (inner.name in value)
        rows.push(
          ...this.row(
            inner,
            paths.map((path) => [...path, inner.name]),
            key,
          ),
        );
      else absent.push(inner);
    }
    if (!absent.length) return rows;
    const id = `more-${paths[0].join("-")}`;
    const choice = make(
      "select",
      { class: "more", id, "data-table": key.name, "aria-label": `add to ${key.name}` },
      make("option", { value: "" }, "add .."),
    );
    for (const inner of absent) {
      const option = make("option", { value: inner.name, title: inner.meaning }, inner.name);
      const changes = paths.flatMap((path) => this.additions(key, inner, path));
      this.offers.push({ option, changes, meaning: inner.meaning });
      choice.append(option);
    }
    // A button: arrow keys go through the choices of a closed menu, and each would be a change.
    const onclick = () => {
      const inner = absent.find((k) => k.name === choice.value);
      if (!inner) return choice.focus();
      this.state.set(paths.flatMap((path) => this.additions(key, inner, path)), null, true);
    };
    return [...rows, choice, make("button", { type: "button", class: "more", id: `${id}-add`, onclick }, "add")];
  }

  /** The changes that add a key: if it is another way to say something, the first way goes. */
  additions(key, inner, path) {
    const axes = this.state.get(["axis"])?.length ?? 2;
    const first = (one) => {
      const value = firstValue(one);
      return one.per_axis ? Array.from({ length: axes }, (_, i) => value[i] ?? 0) : value;
    };
    const named = (name) => key.keys.find((k) => k.name === name);
    const way = otherWay(key, inner);
    if (!way) return alongWith(key, inner).map((name) => [[...path, name], first(named(name))]);
    const barred = Object.keys(way.properties ?? {}).map((name) => [[...path, name], undefined]);
    return [...barred, ...way.required.map((name) => [[...path, name], first(key.keys.find((k) => k.name === name))])];
  }

  row(key, paths, table) {
    const value = this.state.get(paths[0]);
    if (key.type === "numbers" && typeof value === "number")
      return [this.one({ ...key, type: key.whole ? "integer" : "number" }, paths, table)];
    if (key.type === "numbers" && Array.isArray(value) && value.length <= 9)
      return value.map((_, i) =>
        this.one(
          { ...key, type: key.whole ? "integer" : "number" },
          paths.map((p) => [...p, i]),
          table,
          i,
        ),
      );
    return [this.one(key, paths, table)];
  }

  one(key, paths, table, index) {
    const id = paths[0].join("-");
    // The taps of a response have the sum 1.
    const change = (path, value) =>
      index !== undefined && key.name.endsWith("_taps")
        ? [path.slice(0, -1), shares(this.state.get(path.slice(0, -1)), index, value)]
        : [path, value];
    const put = (value) =>
      this.state.set(
        paths.map((path) => change(path, value)),
        id,
      );
    const label = `${shortName(key)}${index === undefined ? "" : ` ${index + 1}`}`;
    const { state, updates } = this;
    const grain = key.of_period && (() => state.get(["sample_period_ms"]));
    const list = index === undefined ? null : paths[0].slice(0, -1);
    // The ends of a band stay in their order.
    const others = () => (isBand(key, state.get(list)) ? [state.get([...list, 1 - index])] : []);
    const between = list && (() => (index ? { from: others()[0] } : { to: others()[0] }));
    const entry = field({ ...key, grain, between }, paths[0], { id, state, put, table, updates });
    const drop = index > 0 || !table ? null : this.drop(key, paths, table, { id, label, inList: Boolean(list) });
    return make(
      "div",
      {
        class: "row",
        title: `${key.name}: ${key.meaning}`,
        "data-key": table ? `${table.name}.${key.name}` : key.name,
      },
      make("label", { for: id }, label, key.unit ? make("small", {}, ` ${unit(key.unit)}`) : null),
      entry,
      drop,
    );
  }

  /** A button that removes a key, with those that it needs beside it; null where the table must have it. */
  drop(key, paths, table, { id, label, inList }) {
    const places = paths.map((path) => path.slice(0, inList ? -2 : -1));
    if (isNeeded(table, key, this.state.get(places[0]) ?? {})) return null;
    const changes = places.flatMap((place) => alongWith(table, key).map((name) => [[...place, name], undefined]));
    const meaning = `without ${key.name}: ${key.fallback ?? "none"}`;
    const onclick = () => this.state.set(changes, null, true);
    const names = { class: "drop", id: `${id}-drop`, title: meaning, "aria-label": `remove ${label}` };
    const option = make("button", { type: "button", ...names, onclick }, "\u00d7");
    this.offers.push({ option, changes, meaning, removes: true });
    return option;
  }
}
