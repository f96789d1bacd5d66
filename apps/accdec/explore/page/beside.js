// Which filter is drawn in grey beside the design: today's, a family that was chosen, or the best that a control has.
import { filterOfToday } from "./format.js";
import { askJson, Latest } from "./requests.js";

/** The task with this filter in place of a choice; bits are those of taps that are designed. */
export const withFilter = (task, filter) => ({
  ...task,
  filter,
  baseline: undefined,
  design: task.design && { ...task.design, coefficient_bits: undefined },
});

/** The family that the address or a click names; where there is no filter of today, the fastest. */
function wanted(task, families, { beside }) {
  if (filterOfToday(task) && (beside ?? "today") === "today") return null;
  const held = families.filter((f) => f.filter);
  const chosen = held.find((f) => f.name === beside);
  return chosen ?? (filterOfToday(task) ? null : held.sort((a, b) => a.objective_s - b.objective_s)[0] ?? null);
}

export class Beside {
  /** draw(): called where another filter, or its answer, is to be drawn; corner(): the index of the one shown. */
  constructor(draw, corner) {
    Object.assign(this, { draw, family: null, answer: null });
    this.member = new Latest(
      (task) => askJson("design", task, { seconds: 2, slot: "member", format: "given", corner: corner() }),
      (answer) => {
        this.answer = answer;
        draw();
      },
      () => {
        this.answer = null; // it spoke of another task
        draw();
      },
    );
  }

  /** Of these families; asks about the filter where it is another one. */
  choose(task, families, choices) {
    // A family that is not known in a moment is kept until it is.
    const known = families.some((f) => f.name === choices.beside && f.filter);
    const kept = this.family && this.family.name === choices.beside && !known;
    const next = kept ? this.family : wanted(task, families, choices);
    const same = JSON.stringify(next?.filter) === JSON.stringify(this.family?.filter);
    if (next?.name !== this.family?.name) this.answer = null;
    this.family = next;
    if (!same) this.ask(task);
  }
  ask(task) {
    if (this.family) this.member.put(withFilter(task, this.family.filter));
  }
}
