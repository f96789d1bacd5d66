// The page: a change of the task asks for the families, today's filter and the design, and shows each as it comes.
import { Beside, withFilter } from "./beside.js";
import { Controls } from "./controls.js";
import { Chart } from "./curves.js";
import { Designs, longer, longestSearch } from "./designs.js";
import { FilterCharts } from "./filter.js";
import { $, filterOfToday, objective } from "./format.js";
import { showUndo } from "./history.js";
import { blendOnly, distances, Motion } from "./motion.js";
import { drawPath } from "./path.js";
import { better, unfinished } from "./proof.js";
import { Latest, askJson, begin, latency, stayAlive } from "./requests.js";
import { pageText } from "./save.js";
import { State } from "./state.js";
import { summary } from "./summary.js";
import { brief, cornerButtons, cornerTable, familyTable, tapTable, todayText } from "./tables.js";
import { tools } from "./tools.js";
import { Views } from "./views.js";

const page = { design: null, families: null, today: null, planned: "" };
const delays = (result) => result.corners.map((c) => c.delay_samples);
const textOf = (task) => JSON.stringify(task);
/** Whether the design shown is of this task. While it is not, curves wait for it: they are drawn once. */
const settled = () => page.design?.of === textOf(state.task);
const isNow = (task) => textOf(task) === textOf(state.task);
const found = (answer) => (answer?.result.filter ? answer : null);

// First of all: the program ends once no page tells that it is open.
stayAlive((gone) => document.body.classList.toggle("gone", gone));
const start = await begin();
const shared = (globalThis.accdecPage = { start, state: null, page, note });
shared.pageText = (wait) => pageText(shared, wait);
/** Answers under way that replace what is drawn, in words. */
shared.awaited = () => {
  const drawn = [today, beside.member, views.latest, viewsBefore.latest];
  const asked = {
    "the design": [designs.whole],
    "a longer search": [designs.meanwhile],
    "the families": [families, thorough],
    "what is drawn": drawn,
  };
  return Object.keys(asked).filter((name) => asked[name].some((one) => one.busy || one.next));
};
const state = (shared.state = new State(start.task, changed, chosen));
/** The task as a program's page opened it, with the feeds that its plan passes the corner at. */
if (state.choices.planned) page.planned = textOf(state.task);
const corner = () => state.choices.corner ?? 0;
const beside = new Beside(() => draw(settled()), corner);
const views = new Views("view", () => draw(), (error) => (trouble(`Not drawn: ${error.message}`), draw()));
const viewsBefore = new Views("before", () => draw(), () => {});
const refusals = (tasks) => askJson("check", tasks, { slot: "check" }).catch(() => null);
const controls = new Controls($("#controls"), start.keys, state, refusals);
const motion = new Motion($("#motion"));
const filters = new FilterCharts($("#taps"), $("#response"));
const off = new Chart($("#off"), { height: 290, between: true });

/** For as long as it takes to read; lasting: until the next one. */
function note(text, lasting = false) {
  $("#note").textContent = text;
  clearTimeout(note.timer);
  if (!lasting) note.timer = setTimeout(() => ($("#note").textContent = ""), 4000 + 100 * text.length);
}

/** Until there is another design. */
const trouble = (text) => (page.trouble = text);
if (state.broken) note("The address holds no task that can be read: this is the first one.");

// --- questions ---

const designs = new Designs(corner, showDesign, fail, () => draw(false));
// Families found within a frame or two are shown at once. Then the program is free for the design.
const families = new Latest(
  (task) => askJson("families", task, { seconds: 0.015, ends: [longer, "thorough"] }),
  (answer, task) => {
    showFamilies(answer, task);
    latency("families");
    askRest(task);
  },
  (error, task) => askRest(task),
);
const thorough = new Latest(
  (task) => askJson("families", task, { seconds: 2, slot: "thorough" }),
  showFamilies,
  () => {},
);
const today = new Latest(
  (task) =>
    askJson("design", withFilter(task, filterOfToday(task)), {
      seconds: 2,
      slot: "today",
      format: "given",
      corner: corner(),
    }),
  (answer, task) => {
    page.today = { ...answer, of: textOf(task) };
    draw(settled() && isNow(task));
  },
  () => {
    page.today = null; // it spoke of another task
    draw(settled());
  },
);
function fail(error, task) {
  if (!isNow(task)) return;
  page.design = page.families = null;
  document.body.classList.remove("stale");
  document.body.classList.add("failed");
  trouble(error.message);
  draw(false);
}

function changed(structure) {
  // The task may be again the one that is shown.
  document.body.classList.toggle("stale", !settled());
  document.body.dataset.task = JSON.stringify(state.task);
  const told = $("#limits .wide");
  told.classList.toggle("old", told.dataset.task !== document.body.dataset.task);
  performance.mark("changed");
  // The program works while the browser draws the sliders.
  ask();
  if (structure) controls.build();
  else controls.update();
  showUndo(state.history);
  shared.named?.();
}

/** The same task is shown otherwise. */
function chosen() {
  showUndo(state.history);
  $("#whole").checked = Boolean(state.choices.whole);
  if (page.families) beside.choose(state.task, page.families.families, state.choices);
  draw();
}

function ask() {
  const task = structuredClone(state.task);
  designs.drop(), thorough.drop();
  families.put(task);
}

function askRest(task) {
  designs.put(task);
  if (filterOfToday(task)) today.put(task);
  else page.today = null;
  beside.ask(task);
}

// --- answers ---

function showDesign(answer, task) {
  const next = { ...answer, of: textOf(task) };
  if (settled() && !isNow(task)) return;
  if (page.design?.of !== next.of) latency("design");
  if (!better(next, page.design)) return draw(false);
  page.design = next;
  trouble("");
  if (settled()) document.body.classList.remove("stale");
  draw();
  // The families that take longer do not hold up the proof.
  const { of, complete } = page.families ?? {};
  if (of === page.design.of && !complete && showDesign.thorough !== of) {
    showDesign.thorough = of;
    thorough.put(task);
  }
}

/** A family that is not searched to the end keeps its older numbers, in grey. */
function withOlder(answer) {
  const known = new Map((page.families?.families ?? []).map((f) => [f.name, f]));
  const older = (f) => (known.get(f.name)?.filter ? known.get(f.name) : f);
  return { ...answer, families: answer.families.map((f) => (f.status === "failed" ? older(f) : f)) };
}

function showFamilies(answer, task) {
  const of = textOf(task);
  page.families = { ...withOlder({ ...answer, families: answer.families.map((f) => ({ ...f, of })) }), of };
  beside.choose(task, page.families.families, state.choices);
  draw(false);
}

// --- drawing: once a frame, whatever has come ---

/** @param curves  false where only tables have changed */
function draw(curves = true) {
  draw.curves ||= curves;
  cancelAnimationFrame(draw.frame);
  draw.frame = requestAnimationFrame(drawNow);
}

const compared = () => found(beside.family ? beside.answer : page.today);

function drawNow() {
  const answer = found(page.design);
  page.searching = designs.searching || (designs.finding && settled());
  page.seeking = Boolean(page.searching && page.design && !answer && unfinished(page.design));
  page.beginning = !page.design && Boolean(designs.finding || families.busy || families.next);
  page.cut = designs.cut && settled() && !page.searching ? longestSearch : 0;
  if (page.design) document.body.classList.toggle("failed", !answer && !page.seeking);
  if (page.design) document.body.classList.add("ready");
  document.body.classList.toggle("seeking", page.seeking);
  summary(page);
  drawFamilies();
  if (!answer || !draw.curves) return;
  draw.curves = false;
  document.body.classList.add("drawn");
  const { result } = answer;
  const before = compared();
  const i = Math.min(corner(), result.task.corner.length - 1);
  cornerButtons($("#corners"), result, i, (corner) => state.choose({ corner }));
  const period = result.sample_period_s * 1e3;
  const name = beside.family ? brief(beside.family.title) : "today";
  $("#beside").textContent = before ? name : "(nothing to compare with)";
  $("#corner-table .wide").replaceChildren(cornerTable(answer.corners));
  if ($("#tap-table").open) $("#tap-table .wide").replaceChildren(tapTable(result));
  filters.show(result, before?.result.filter);
  const view = views.of(answer, i),
    old = viewsBefore.of(before, i);
  for (const place of ["#path", "#off", "#motion"]) $(place).hidden = view === false;
  if (!view) return;
  const tolerance = result.task.corner[i].error_max_um ?? null;
  drawPath(
    $("#path .draw"),
    { view, corner: result.corners[i], tolerance },
    old ? { view: old } : null,
  );
  const ends = ({ result }) => {
    const { delay_samples, settling_time_s = 0 } = result.corners[i];
    return period * (result.filter.order + delay_samples + 4) + settling_time_s * 1e3;
  };
  const { whole } = state.choices;
  const x = whole ? null : [-period, Math.max(ends(answer), old ? ends(before) : 0)];
  const [shown, shownBefore] = whole ? [view, old] : [blendOnly(view), old && blendOnly(old)];
  const distance = (v, before) => ({
    label: before ? "before" : "design",
    ...distances(v, period),
    before,
  });
  const most = result.task.corner[i].contour_max_um;
  const said = `largest ${(1e6 * result.corners[i].contour_deviation_m).toFixed(2)}`;
  off.show(
    [...(old ? [distance(shownBefore, true)] : []), { ...distance(shown, false), bounds: [most] }],
    most ? [{ value: most }] : [],
    { period, x, title: `Distance from the legs / \u00b5m: ${said}` },
  );
  motion.show(shown, shownBefore, period, x, result.task.corner[i].speed_min_mm_s ?? null);
}

/** The part of an answer that a row of the table has, with the task it speaks of. */
const rowOf = ({ result, of, exact_stop }) => ({
  objective_s: objective(result),
  delays_samples: delays(result),
  exact_stop,
  of,
});

function drawFamilies() {
  if (!page.families) return $("#families .wide").replaceChildren();
  const result = found(page.design)?.result;
  const now = result && {
    ...rowOf(page.design),
    name: result.task.filter ? "the filter given" : result.settings ? "the design" : "free taps",
    order: result.filter.order,
  };
  const own = found(page.today);
  const row = own && (result || page.today.of === page.families.of) && { ...rowOf(own), text: todayText(own) };
  const place = $("#families .wide");
  const focused = place.contains(document.activeElement) && document.activeElement.closest("tr")?.dataset.name;
  // The families of an older task stand beside a design only.
  const task = textOf(state.task);
  const shown = result ? page.families.families : page.families.families.filter((f) => f.of === task);
  place.replaceChildren(
    ...familyTable(
      shown,
      row,
      now,
      task,
      (state.task.sample_period_ms ?? 1) / 1e3,
      beside.family?.name ?? "today",
      (which) => state.choose({ beside: which.name ?? which }),
      place.querySelector("details")?.open,
    ),
  );
  if (focused) place.querySelector(`tr[data-name="${focused}"] button`)?.focus();
}

// --- the rest ---

tools(shared, draw);
chosen();
changed(false);
