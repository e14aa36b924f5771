// The view (what is filtered, sorted, selected), kept in the URL's hash so that a link opens the same one.

type Listener = (changed: ReadonlySet<string>) => void;

const defaults: Record<string, string> = {};
let values = new Map<string, string>();
const listeners: { keys: readonly string[]; call: Listener }[] = [];

function parse(): Map<string, string> {
  return new Map(new URLSearchParams(location.hash.replace(/^#/, '')));
}

export function get(key: string): string {
  return values.get(key) ?? defaults[key] ?? '';
}

export function setDefault(key: string, value: string): void {
  defaults[key] = value;
}

/**
 * Changes values and tells those who listen; a value equal to its default leaves the URL. `step`: the reader has gone
 * somewhere, and the browser's Back leads back from there.
 */
export function set(changes: Record<string, string>, step = false): void {
  const changed = new Set(Object.keys(changes).filter((key) => get(key) !== changes[key]));
  for (const key of changed) {
    const value = changes[key] ?? '';
    if (value === (defaults[key] ?? '')) values.delete(key);
    else values.set(key, value);
  }
  if (changed.size === 0) return;
  const text = new URLSearchParams([...values]).toString();
  const address = text === '' ? location.pathname + location.search : `#${text}`;
  if (step) history.pushState('view', '', address);
  else history.replaceState('view', '', address);
  tell(changed);
}

/** Calls back after any of `keys` changed: of the address, or those that tell() names. */
export function listen(keys: readonly string[], call: Listener): void {
  listeners.push({ keys, call });
}

export function tell(changed: ReadonlySet<string>): void {
  for (const { keys, call } of listeners) {
    if (keys.some((key) => changed.has(key))) call(changed);
  }
}

export function start(): void {
  values = parse();
  addEventListener('hashchange', () => {
    const next = parse();
    const changed = new Set([...values.keys(), ...next.keys()].filter((key) => values.get(key) !== next.get(key)));
    values = next;
    if (changed.size > 0) tell(changed);
  });
}
