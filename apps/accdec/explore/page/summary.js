// The answer in one sentence, what it saves, and the badge.
import { $, filterOfToday, make, ms, objective } from "./format.js";
import { proved } from "./proof.js";

/** Of what the design is proved to be the fastest. */
const candidates = ({ task, settings }) =>
  task.filter ? "delays of this filter" : settings ? "settings of this control" : "filter and delays";

/** The badge's word and what stands behind it. */
function badge({ design: answer, seeking, beginning }) {
  if (!answer) return beginning ? ["searching", ""] : ["no answer", ""];
  const { result, proof } = answer;
  if (seeking) return ["searching", result.message];
  if (proved(answer))
    return [
      "proved",
      `No ${candidates(result)} within the limits are faster: ${proof.text}. The motion was simulated again.`,
    ];
  if (result.status === "optimal")
    return ["best", `The search found nothing faster; its proof was not rechecked: ${proof.text}`];
  if (result.status === "feasible")
    return [
      "verified",
      result.lower_bound_s
        ? `Proved so far: none is shorter than ${ms(result.lower_bound_s)} ms.`
        : "Verified by simulation.",
    ];
  return [result.status, result.message];
}

const cutText = (seconds) =>
  `The search of accdec design was cut off here after ${seconds} s; by itself it may end with another filter.`;

/** Where there is no filter. */
function sayNone({ seeking, beginning, cut }, result) {
  const none = result?.status === "infeasible";
  const still = seeking || beginning ? "No filter found so far: the search goes on." : "No design so far.";
  $("#sentence").textContent = none ? "No filter holds these limits." : still;
  $("#today").textContent = none
    ? "\u201cFind out\u201d below says how much each limit has to give."
    : cut
      ? cutText(cut)
      : "";
}

export function summary(page) {
  const [word, why] = badge(page);
  const more = page.searching && page.design && !page.seeking && !proved(page.design);
  $("#badge").textContent = more ? `${word}, searching on` : word;
  $("#badge").dataset.is = word;
  $("#badge").title = why;
  const result = page.design?.result;
  const failed = result && !result.filter && !page.seeking;
  const trouble = page.trouble || (failed ? `No design: ${result.message}` : "");
  $("#trouble").textContent = trouble;
  $("#trouble").hidden = !trouble;
  if (!result?.filter) return sayNone(page, result);
  const task = JSON.parse(page.design.of);
  const time = objective(result);
  const what = result.task.filter ? "With the filter given" : result.settings ? "This control" : "Free taps";
  const corners = result.corners.length;
  $("#sentence").replaceChildren(
    `${what}: `,
    make("b", { id: "time", "data-value": time }, `${ms(time)} ms`),
    corners > 1 ? ` for ${corners} corners` : " for the corner",
    more ? " so far." : ".",
  );
  const parts = [];
  // A sentence speaks of one task: answers about another have no part in it.
  const same = (answer) => (answer?.of === page.design.of ? answer : null);
  const today = same(page.today);
  const own = today?.result.filter ? today.result : null;
  const fits = (f) => f.objective_s !== undefined && f.of === page.design.of;
  const best = same(page.families)?.families.filter(fits) ?? [];
  // Where the control restricts the delays, the result has its savings itself.
  const savings = result.savings ?? (own && { today_s: objective(own), total_s: objective(own) - time });
  if (filterOfToday(task) && savings) {
    const saved = savings.total_s;
    const retuned = best.find((f) => f.name === page.families.own_family);
    const by = retuned ? ms(savings.today_s - retuned.objective_s) : "0";
    const less = ms(saved) === "0" ? "just as long" : saved < 0 ? `${ms(-saved)} ms more` : `${ms(saved)} ms less`;
    parts.push(
      `Today: ${ms(savings.today_s)} ms; `,
      make("b", { id: "saved", "data-value": saved }, less),
      by === "0" ? "" : ` (${by} by setting today\u2019s filter otherwise)`,
      ".",
    );
  } else if (filterOfToday(task)) {
    const no =
      page.planned === page.design.of
        ? "In its program, today\u2019s filter holds here: feeds change in steps there. From rest to rest it does not:"
        : "Today\u2019s filter does not hold these limits:";
    parts.push(today ? `${no} ${today.result.message}` : "Today\u2019s filter is computed ..");
  } else if (best.length) {
    const least = best.reduce((a, b) => (b.objective_s < a.objective_s ? b : a));
    const what = page.families.complete ? "Best" : "Best so far";
    parts.push(`${what} of the filters that controllers have: ${least.title}, ${ms(least.objective_s)} ms.`);
  }
  if (page.cut) parts.push(` ${cutText(page.cut)}`);
  $("#today").replaceChildren(...parts);
  $("#setting").textContent = page.design.setting ?? "";
  $("#setting").hidden = !page.design.setting;
}
