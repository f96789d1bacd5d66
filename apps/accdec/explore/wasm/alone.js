// In place of the server: the page's questions go to workers that hold the library.

/** The module is packed and in base64, in an element of the page. */
async function unpacked(id) {
  const text = atob(document.getElementById(id).textContent.trim());
  const packed = Uint8Array.from(text, (c) => c.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"));
  return new Response(stream).arrayBuffer();
}

const library = unpacked("library").then((bytes) => WebAssembly.compile(bytes));
const script = URL.createObjectURL(
  new Blob([document.getElementById("worker").textContent], { type: "text/javascript" }),
);
const workers = new Map(); // by question and slot: one asks while another computes
const refused = () => new Response(null, { status: 204 });

async function worker() {
  const made = new Worker(script);
  made.postMessage({ module: await library });
  return made;
}

/** Nobody wants its answer any more. */
function end(kind) {
  const one = workers.get(kind);
  if (!one?.answer) return;
  workers.delete(kind);
  one.worker.then((w) => w.terminate());
  one.answer(refused());
}

/** As fetch; of questions of one kind only the last is answered, as the server has it. */
async function fetch(address, { body = "" } = {}) {
  const url = new URL(address, "http://page/"),
    name = url.pathname.slice(1);
  const style = document.querySelector(`style[data-name="${name}"]`);
  if (style) return new Response(style.textContent);
  const ask = Object.fromEntries(url.searchParams);
  const kind = `${name} ${ask.slot ?? ""}`;
  const ended = url.searchParams.getAll("ends");
  for (const one of [...workers.keys()]) if (one === kind || ended.includes(one.split(" ")[1])) end(one);
  const mine = { worker: workers.get(kind)?.worker ?? worker() };
  workers.set(kind, mine);
  // A whole search has no time limit of its own.
  if ("whole" in ask) setTimeout(() => workers.get(kind) === mine && end(kind), 1e3 * ask.seconds);
  return new Promise((answer) => {
    mine.answer = answer;
    mine.worker.then((w) => {
      if (workers.get(kind) !== mine) return;
      w.onmessage = ({ data }) => {
        mine.answer = null;
        answer(new Response(data.bytes, { status: data.status, headers: { "Content-Type": data.type } }));
      };
      const { format = "", corner = 0, seconds = 1 } = ask;
      w.postMessage({ name, body, format, corner: Number(corner), seconds: Number(seconds), whole: "whole" in ask });
    });
  });
}

/** There is no program that could end, and no other window that would have to know. */
const navigator = { clipboard: globalThis.navigator.clipboard, locks: { request() {} } };
