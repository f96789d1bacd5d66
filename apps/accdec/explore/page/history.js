// States that a user may come back to, by undo and redo.
import { $ } from "./format.js";

/** The buttons of the page, where they would do nothing: disabled, they would lose the focus of who presses them. */
export function showUndo({ past, future }) {
  $("#undo").setAttribute("aria-disabled", String(!past.length));
  $("#redo").setAttribute("aria-disabled", String(!future.length));
}

/** Ctrl-Z, and Ctrl-Y or Ctrl-Shift-Z; a text field has them for itself. */
export function undoByKeys(state) {
  addEventListener("keydown", (event) => {
    const key = event.key.toLowerCase();
    if (!(event.ctrlKey || event.metaKey) || !["z", "y"].includes(key)) return;
    if (event.target.matches?.("input[type=text]")) return;
    event.preventDefault();
    key === "y" || event.shiftKey ? state.redo() : state.undo();
  });
}

const kept = 500; // states

export class History {
  constructor() {
    Object.assign(this, { past: [], future: [] });
  }

  /** `now` is about to be replaced. */
  leave(now) {
    this.past.push(now);
    if (this.past.length > kept) this.past.shift();
    this.future = [];
  }
  /** The state before `now`; undefined where there is none. */
  undo(now) {
    return this.move(this.past, this.future, now);
  }
  /** The state that was left by undo. */
  redo(now) {
    return this.move(this.future, this.past, now);
  }
  move(from, to, now) {
    if (from.length) to.push(now);
    return from.pop();
  }
}
