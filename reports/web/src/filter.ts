// Which rows of the table a search finds, in the order asked for; quick enough for every key stroke with 100,000 trials:
// texts are looked at once per distinct value, and rows stay sorted from one key stroke to the next.

import type { Model } from './data';
import * as state from './state';
import { view, type View } from './view';

const kSearched = ['trial', 'controller', 'point', 'family', 'outcome', 'link', 'object', 'reason', 'store'];

/** Lower-case values by column; of the data that is loaded now. */
const lowered = new WeakMap<readonly string[], string[]>();

function lower(values: readonly string[]): string[] {
  let known = lowered.get(values);
  if (known === undefined) {
    known = values.map((value) => value.toLowerCase());
    lowered.set(values, known);
  }
  return known;
}

/** Whether a row holds `word` in any of its texts, or as the world's number: "world:12". */
function finder(model: Model, word: string): (row: number) => boolean {
  const t = model.trials;
  const columns = kSearched.map((name) => t.column(name)).filter((column) => column.values.length > 0)
    .map((column) => ({ codes: column.codes, hit: Uint8Array.from(lower(column.values), (value) => (value.includes(word) ? 1 : 0)) }))
    .filter((column) => column.hit.includes(1));
  const numbered = /^(w?o?r?l?d?:)?\d*$/.test(word) || 'world:'.includes(word);
  const worlds = new Map<number, boolean>();
  const isWorld = (row: number): boolean => {
    const world = t.number('world', row);
    let hit = worlds.get(world);
    if (hit === undefined) worlds.set(world, hit = `world:${world}`.includes(word));
    return hit;
  };
  return (row) => columns.some((column) => column.hit[column.codes[row] ?? -1] === 1) || (numbered && isWorld(row));
}

let sortedOf: View | null = null;
let sortedBy = '';
let sorted: number[] = [];

/** All rows of the shown series in the chosen order; `last` is the text of the last column. */
function inOrder(model: Model, isText: (key: string) => boolean, last: (row: number) => string): number[] {
  const now = view();
  const by = state.get('sort');
  if (sortedOf === now && sortedBy === by) return sorted;
  const t = model.trials;
  const [key = 'world', direction = 'up'] = by.split(':');
  const sign = direction === 'down' ? -1 : 1;
  const rows = now.series.flatMap((s) => [...s.rows, ...s.errors]);
  if (key === 'contact') {
    const texts = new Map(rows.map((row) => [row, last(row)]));
    rows.sort((a, b) => sign * (texts.get(a) ?? '').localeCompare(texts.get(b) ?? ''));
  } else if (isText(key)) {
    // Codes are compared through their rank, so that no string is compared twice.
    const { values, codes } = t.column(key);
    const rank = new Map([...values.keys()].sort((a, b) => ((values[a] ?? '') < (values[b] ?? '') ? -1 : 1)).map((code, i) => [code, i]));
    const at = Float64Array.from(codes, (code) => rank.get(code) ?? -1);
    rows.sort((a, b) => sign * ((at[a] ?? -1) - (at[b] ?? -1)));
  } else {
    const at = Float64Array.from({ length: t.n }, (_, row) => {
      const value = sign * t.number(key, row);
      return Number.isNaN(value) ? Infinity : value;   // none: last
    });
    rows.sort((a, b) => (at[a] === at[b] ? 0 : (at[a] ?? 0) - (at[b] ?? 0)));
  }
  [sortedOf, sortedBy, sorted] = [now, by, rows];
  return rows;
}

/** Rows that pass the filters, in the order asked for. */
export function filtered(model: Model, isText: (key: string) => boolean, last: (row: number) => string): number[] {
  const t = model.trials;
  const outcome = state.get('outcome');
  const who = state.get('who');
  const words = state.get('q').trim().toLowerCase().split(/\s+/).filter((word) => word !== '');
  let rows = inOrder(model, isText, last);
  if (outcome === 'failure') rows = rows.filter((row) => !t.success(row));
  else if (outcome !== '') rows = rows.filter((row) => t.text('outcome', row) === outcome);
  if (who !== '') rows = rows.filter((row) => t.text('controller', row) === who);
  for (const word of words) rows = rows.filter(finder(model, word));
  return rows;
}
