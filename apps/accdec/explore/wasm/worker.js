// A worker of explorer.html: it holds the library and answers one question at a time.
let library;

onmessage = async ({ data }) => {
  if (data.module) {
    const instantiateWasm = (imports, done) => {
      WebAssembly.instantiate(data.module, imports).then(done);
      return {};
    };
    library = accdec({ instantiateWasm, printErr: () => {} });
    return;
  }
  const l = await library;
  try {
    const { name, body, format, corner, seconds, whole } = data;
    const at =
      name === "start"
        ? l._accdec_start()
        : l.ccall(
            "accdec_answer",
            "number",
            ["string", "string", "string", "number", "number", "boolean"],
            [name, body, format, corner, seconds, whole],
          );
    const bytes = l.HEAPU8.slice(at, at + l._accdec_length());
    postMessage({ status: l._accdec_status(), type: l.UTF8ToString(l._accdec_type()), bytes }, [bytes.buffer]);
  } catch (error) {
    const bytes = new TextEncoder().encode(JSON.stringify({ error: `the library ended: ${error}` }));
    postMessage({ status: 500, type: "application/json", bytes });
  }
};
