// What an answer to "design" has proved, and whether a longer search may say more.

export const proved = (answer) => answer?.result.status === "optimal" && answer.proof.rechecked;

/** Whether a longer search may find something faster, or a proof that was not found or rechecked in time. */
export const unfinished = ({ result, proof }) =>
  result.stop === "time limit" || (result.status === "optimal" && !proof.rechecked);

/**
 * Whether methods may have been cut off before one of them found the proof: with more time another filter as fast may be
 * found, which is that of the command line. Less than the smallest share of the time cuts nothing off.
 * @param seconds  that the search had
 */
export const hurried = ({ result }, seconds) => !(result.solver.wall_time_s < 0.05 * seconds);

/** Keeps what is proved: on a machine that has other work, a longer search may come less far. */
export const better = (now, before) => !(before && proved(before) && before.of === now.of && !proved(now));
