// The motion at the corner that is shown: an answer has that of one corner, others are asked for.
import { about, askJson, Latest } from "./requests.js";

export class Views {
  /**
   * @param slot  of its questions
   * @param draw  called where another motion has come
   * @param fail  called with an error where a motion cannot be drawn
   */
  constructor(slot, draw, fail) {
    this.latest = new Latest(
      ({ answer, corner }) => askJson("view", ...about(answer, { corner, slot, seconds: 20 })),
      (view, { answer, corner }) => ((answer.views[corner] = view), draw()),
      (error, { answer, corner }) => ((answer.views[corner] = false), fail(error)),
    );
  }

  /** The motion of an answer to "design"; null until it has come, and false where it cannot be drawn. */
  of(answer, corner) {
    const view = answer?.views[corner] ?? null;
    const asked = this.asked?.answer === answer && this.asked?.corner === corner;
    if (answer && view === null && !asked) this.latest.put((this.asked = { answer, corner }));
    return view;
  }
}
