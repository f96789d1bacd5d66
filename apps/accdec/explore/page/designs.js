// The design of a task as the command line has it, and what is found until that is there.
import { unfinished } from "./proof.js";
import { askJson, Latest } from "./requests.js";

const most = 20; // s, for a search
const moment = 0.6; // s, for what is shown until then
const soon = 300; // ms: most proofs are there
export const longer = "longer"; // the slot of these

export class Designs {
  /**
   * @param corner  gives the index of the one that is drawn
   * @param show    called with an answer, `complete` if nothing else will be found, and its task
   * @param fail    called with an error
   */
  constructor(corner, show, fail) {
    const ask = (task, options) => askJson("design", task, { corner: corner(), ...options });
    this.whole = new Latest(
      (task) => ask(task, { whole: true, seconds: most }),
      (answer, task) => {
        const complete = !unfinished(answer);
        if (complete) this.end();
        else if (!this.searching) this.meanwhile.put({ task, seconds: most });
        show({ ...answer, complete }, task);
      },
      fail,
    );
    // Shorter searches try more methods in their time.
    this.meanwhile = new Latest(
      ({ task, seconds }) => ask(task, { seconds, slot: longer }),
      (answer, { task, seconds }) => {
        if (unfinished(answer) && seconds < most) this.meanwhile.put({ task, seconds: most });
        show(answer, task);
      },
      () => {}, // the other question has the same error
    );
  }

  put(task) {
    this.drop();
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
