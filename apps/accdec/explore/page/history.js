// States that a user may come back to, by undo and redo.

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
