// From the table of keys: names, first values, which keys go with which.

/** "acceleration_max_mm_s2" without its unit. */
export function shortName(key) {
  const tail = (key.unit ?? "").replace("^", "").replace(/[ /]/g, "_");
  const plain = key.name.replace(/_(deg|samples)$/, "");
  return (tail && plain.endsWith(`_${tail}`) ? plain.slice(0, -tail.length - 1) : plain).replaceAll("_", " ");
}

/** The first value of a key that is added. */
export function firstValue(key) {
  if (key.type === "boolean") return key.fallback !== "true";
  if (key.type === "word") return key.words.includes(key.fallback) ? key.fallback : key.words[0];
  if (key.type === "table") return firstTable(key);
  const text = key.example ?? key.fallback ?? "0";
  try {
    return JSON.parse(text);
  } catch {
    return key.default ?? 0;
  }
}

/** A table that is added: with all that it needs, and of keys that exclude each other those of the first way. */
export function firstTable(key) {
  const value = {};
  for (const inner of key.keys ?? []) if (inner.required) value[inner.name] = firstValue(inner);
  const ways = key.conditions?.oneOf ?? [];
  const chosen = ways.some((way) => way.required?.every((name) => name in value)) ? [] : (ways[0]?.required ?? []);
  for (const name of [...neededBy(key, value), ...chosen])
    value[name] ??= firstValue(key.keys.find((k) => k.name === name));
  return value;
}

/** The condition of a table's kind of filter. */
export function ofKind(key, value) {
  const all = key.conditions?.allOf ?? [];
  return all.find((c) => c.if?.properties?.kind?.const === value.kind)?.then ?? {};
}
export const neededBy = (key, value) => ofKind(key, value).required ?? [];
export function barredBy(key, value) {
  const barred = new Set();
  const collect = (properties) => {
    for (const [name, allowed] of Object.entries(properties ?? {})) if (allowed === false) barred.add(name);
  };
  collect(ofKind(key, value).properties);
  for (const one of key.conditions?.oneOf ?? []) {
    if (one.required?.every((name) => name in value)) collect(one.properties);
  }
  return barred;
}

/** A key and those that it needs beside it. */
export const alongWith = (key, inner) => [inner.name, ...(key.conditions?.dependentRequired?.[inner.name] ?? [])];

/** The alternative of a table that a key belongs to. */
export const otherWay = (key, inner) => key.conditions?.oneOf?.find((way) => way.required?.includes(inner.name));

/** Whether a table of this value must have the key: without it there is no task. */
export const isNeeded = (key, inner, value) =>
  Boolean(inner.required || neededBy(key, value).includes(inner.name) || otherWay(key, inner));

/** Whether a list is the two ends of a band. */
export const isBand = (key, list) => key.lone && key.most === 2 && Array.isArray(list) && list.length === 2;

/** Taps with the sum 1, one of them new: the others share what is left as they did before. */
export function shares(taps, index, value) {
  const rest = taps.reduce((sum, tap, i) => (i === index ? sum : sum + tap), 0);
  const part = (tap) => (rest ? tap / rest : 1 / (taps.length - 1));
  return taps.map((tap, i) => (i === index ? value : (1 - value) * part(tap)));
}
