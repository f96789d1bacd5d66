// The design of a task as the command line has it, and what is found until that is there.
import { cutOff, unfinished } from "./proof.js";
import { askJson, Latest } from "./requests.js";

export const longestSearch = 60; // s, for the search of the command line: no question has longer
const moment = 0.6; // s, for what is shown until then
const second = 20; // s, for a better one
const soon = 300; // ms: most proofs are there
export const longer = "longer"; // the slot of these

export class Designs {
  /**
   * @param corner  gives the index of the one that is drawn
   * @param show    called with an answer, `complete` if nothing else will be found, and its task
   * @param fail    called with an error and the task
   * @param ended   called where the search of the command line ended without an answer
   */
  constructor(corner, show, fail, ended) {
    const ask = (task, options) => askJson("design", task, { corner: corner(), ...options });
    this.whole = new Latest(
      (task) => ask(task, { whole: true, seconds: longestSearch }),
      (answer, task) => {
        const complete = !unfinished(answer);
        if (complete) this.end();
        else this.searchOn(task, cutOff(answer));
        show({ ...answer, complete }, task);
      },
      fail,
      (task) => {
        this.searchOn(task, true);
        ended();
      },
    );
    // Shorter searches try more methods in their time.
    this.meanwhile = new Latest(
      ({ task, seconds }) => ask(task, { seconds, slot: longer }),
      (answer, { task, seconds }) => {
        if (unfinished(answer) && seconds < second) this.meanwhile.put({ task, seconds: second });
        show(answer, task);
      },
      () => {}, // the other question has the same error
    );
  }

  /** The search of the command line found no end. @param cut  as its time was over */
  searchOn(task, cut) {
    if (task !== this.task) return;
    this.cut = cut;
    if (!cut && !this.searching) this.meanwhile.put({ task, seconds: second });
  }

  put(task) {
    this.drop();
    Object.assign(this, { task, cut: false });
    this.whole.put(task);
    this.waiting = setTimeout(() => this.finding && this.meanwhile.put({ task, seconds: moment }), soon);
  }
  /** Wants no answer meanwhile; a question about the next task has the program end its search. */
  drop() {
    clearTimeout(this.waiting);
    this.meanwhile.drop();
  }
  end() {
    if (this.searching) askJson("check", [], { ends: [longer] }).catch(() => {});
    this.drop();
  }

  get finding() {
    return Boolean(this.whole.busy || this.whole.next);
  }
  get searching() {
    return Boolean(this.meanwhile.busy || this.meanwhile.next);
  }
}
