// What an answer to "design" has proved, and whether a longer search may say more.

import { objective } from "./format.js";

export const proved = (answer) => answer?.result.status === "optimal" && answer.proof.rechecked;

/** Whether the time ended the search. */
export const cutOff = ({ result }) => ["time limit", "interrupted"].includes(result.stop);

/** Whether a longer search may find something faster, or a proof that was not found or rechecked in time. */
export const unfinished = (answer) =>
  cutOff(answer) || (answer.result.status === "optimal" && !answer.proof.rechecked);

/** Of two answers to one task the complete one is kept, else that which is proved, else the faster one. */
export function better(now, before) {
  if (before?.of !== now.of || now.complete) return true;
  if (before.complete || proved(before) !== proved(now)) return !before.complete && proved(now);
  const time = ({ result }) => (result.filter ? objective(result) : Infinity);
  return time(now) <= time(before);
}
