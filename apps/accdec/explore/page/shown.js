// The shown part of a program: plan, colour, view, time and cursor. Their history, and their copy in the address.
import { History } from "./history.js";

const names = ["plan", "by", "view", "time", "corner", "at"];
const dragged = ["view", "time"];

export class Shown {
  /**
   * show(now, before): called with the new state and the one before, of texts by `names`; "" is what a page begins
   * with.
   */
  constructor(show) {
    Object.assign(this, { told: show, history: new History(), now: this.fromAddress() });
    addEventListener("hashchange", () => {
      const next = this.fromAddress();
      if (names.some((name) => next[name] !== this.now[name])) this.put(next);
    });
  }

  fromAddress() {
    const words = new URLSearchParams(location.hash.slice(1));
    return Object.fromEntries(names.map((name) => [name, words.get(name) ?? ""]));
  }
  toAddress() {
    clearTimeout(this.writing);
    this.writing = setTimeout(() => {
      const word = (name) => `${name}=${encodeURIComponent(this.now[name])}`;
      const words = names.filter((name) => this.now[name]).map(word);
      history.replaceState(null, "", words.length ? `#${words.join("&")}` : location.pathname);
    }, 200);
  }

  /** For the address only: the cursor, which is not undone, and what an address meant that could not be shown so. */
  correct(change) {
    const next = { ...this.now, ...change };
    if (names.every((name) => next[name] === this.now[name])) return;
    this.now = next;
    this.toAddress();
  }

  /** Values that are dragged change many times; changes of one within a second are undone together. */
  set(change) {
    const next = { ...this.now, ...change };
    const changed = names.filter((name) => next[name] !== this.now[name]).join();
    if (!changed) return;
    const together = dragged.includes(changed) && changed === this.last && Date.now() - this.when < 1000;
    this.put(next, together);
    Object.assign(this, { last: changed, when: Date.now() });
  }
  put(next, together = false) {
    if (!together) this.history.leave(this.now);
    this.show(next);
  }

  undo() {
    this.show(this.history.undo(this.now));
  }
  redo() {
    this.show(this.history.redo(this.now));
  }
  show(next) {
    if (!next) return;
    const before = this.now;
    this.now = next;
    this.last = null;
    this.toAddress();
    this.told(next, before);
  }
}
