// Questions to the program, one of a kind at a time.

const client = Math.random().toString(36).slice(2);

export class Superseded extends Error {}

async function post(name, body, options = {}) {
  const { slot = "", seconds = 1, format = "", corner = 0, held = 0, whole = false, ends = [] } = options;
  const query = new URLSearchParams({ client, slot, seconds, format, corner, held });
  if (whole) query.append("whole", "");
  // Slots whose questions are about an older task: the program gives up on them.
  for (const one of ends) query.append("ends", one);
  let response;
  try {
    response = await fetch(`${name}?${query}`, {
      method: "POST",
      headers: { "Content-Type": "application/json" },
      body: typeof body === "string" ? body : JSON.stringify(body),
    });
  } catch {
    throw new Error("the program has ended; start accdec explore again");
  }
  if (response.status === 204) throw new Superseded();
  if (!response.ok) {
    const text = await response.text();
    let what = text;
    try {
      what = JSON.parse(text).error;
    } catch {
      // not from the program's own hand
    }
    throw new Error(what || `the program answers ${response.status}`);
  }
  return response;
}

export const askJson = async (name, body, options) => (await post(name, body, options)).json();
export const askText = async (name, body, options) => (await post(name, body, options)).text();
export const askBlob = async (name, body, options) => (await post(name, body, options)).blob();
/** Body and options of a question about a result: the program holds it, else the page sends it. */
export const about = ({ result, held }, options) => (held ? ["", { ...options, held }] : [result, options]);
export const begin = async () => (await fetch("start")).json();

/** ms from the last change to the drawn answer, for who measures. */
export function latency(name) {
  requestAnimationFrame(() => {
    const from = performance.getEntriesByName("changed").at(-1)?.startTime ?? 0;
    ((globalThis.accdecLatency ??= {})[name] ??= []).push(performance.now() - from);
  });
}

const patience = 150; // ms

/**
 * Asks about the latest value only. While an answer is under way the next question waits, but not longer than
 * `patience`: then it takes the other's place, and the program gives up on that.
 */
export class Latest {
  /** ended(value): called where the program gave up on the question, and no other has taken its place. */
  constructor(ask, show, fail, ended = () => {}) {
    Object.assign(this, { ask, show, fail, ended, number: 0, busy: null, next: undefined });
  }
  put(value) {
    this.next = { value };
    if (!this.busy) this.send();
    else if (!this.timer)
      this.timer = setTimeout(() => this.send(), Math.max(0, this.busy + patience - performance.now()));
  }
  drop() {
    this.next = undefined;
    this.busy = null;
    ++this.number;
  }
  async send() {
    clearTimeout(this.timer);
    this.timer = null;
    if (!this.next) return;
    const { value } = this.next;
    this.next = undefined;
    const number = ++this.number;
    this.busy = performance.now();
    try {
      const answer = await this.ask(value);
      if (number === this.number) this.show(answer, value);
    } catch (error) {
      if (number === this.number) error instanceof Superseded ? this.ended(value) : this.fail(error, value);
    }
    if (number !== this.number) return;
    this.busy = null;
    this.send();
  }
}

/**
 * Tells the program that a page is open, and the page when the program is gone. A browser has six connections to a
 * host, for all its windows: one of them holds the connection that stays, and tells the others.
 */
export function stayAlive(gone) {
  const windows = new BroadcastChannel("accdec");
  windows.onmessage = ({ data }) => gone(data);
  const tell = (is) => (gone(is), windows.postMessage(is));
  navigator.locks.request("accdec", () => new Promise(() => listen(tell)));
}

/** For as long as the page is open. */
function listen(gone) {
  const events = new EventSource("alive");
  events.onopen = () => gone(false);
  events.onerror = async () => {
    if (events.readyState !== EventSource.CLOSED) return gone(true);
    // Refused, as there are many pages: asking from time to time is a sign of life, too.
    const there = await fetch("index.html").then(
      (r) => r.ok,
      () => false,
    );
    gone(!there);
    setTimeout(() => listen(gone), 1000);
  };
}
