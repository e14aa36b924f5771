// Which rows of the table a search finds, in the order asked for; quick enough for every key stroke with 100,000 trials:
// texts are looked at once per distinct value, and rows stay sorted from one key stroke to the next.

import type { Model, PageData } from './data';
import * as state from './state';
import { view, type View } from './view';

const kSearched = ['trial', 'controller', 'point', 'family', 'outcome', 'link', 'object', 'reason', 'store'];

/** A column's distinct values in lower case; by row, which of them it has. */
interface Searched { values: readonly string[]; codes: readonly number[] }

/** Of the data that is loaded now. */
const searched = new WeakMap<PageData['trials'], Searched[]>();

/** The columns that are searched; worlds as "world:12". */
function columns(model: Model): Searched[] {
  let known = searched.get(model.page.trials);
  if (known === undefined) {
    const t = model.trials;
    const worlds = [...new Set(t.values('world'))];
    const place = new Map(worlds.map((world, i) => [world, i]));
    known = [
      ...kSearched.map((name) => t.column(name)).map(({ values, codes }) => ({ values: values.map((value) => value.toLowerCase()), codes })),
      { values: worlds.map((world) => `world:${world}`), codes: Array.from(t.values('world'), (world) => place.get(world) ?? -1) },
    ];
    searched.set(model.page.trials, known);
  }
  return known;
}

/** 1 for each row of which a text holds `word`. */
function found(model: Model, word: string): Uint8Array {
  const rows = new Uint8Array(model.trials.n);
  for (const { values, codes } of columns(model)) {
    const hit = values.map((value) => value.includes(word));
    if (!hit.includes(true)) continue;
    codes.forEach((code, row) => { if (hit[code] === true) rows[row] = 1; });
  }
  return rows;
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
  const rows = now.series.flatMap((s) => s.rows);
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
    const at = t.values(key).map((value) => (Number.isNaN(value) ? Infinity : sign * value));   // none: last
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
  for (const word of words) {
    const has = found(model, word);
    rows = rows.filter((row) => has[row] === 1);
  }
  return rows;
}
