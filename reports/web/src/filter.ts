// Which rows of the table a search finds, in the order asked for; quick enough for every key stroke with 100,000 trials:
// a row's texts are joined once, and rows stay sorted from one key stroke to the next.

import type { Model, PageData } from './data';
import * as state from './state';
import { view, type View } from './view';

/** Columns of texts, which are sorted as such. */
export function isText(key: string): boolean {
  return ['trial', 'controller', 'point', 'family', 'outcome', 'contact'].includes(key);
}

export function contact({ trials: t }: Model, row: number): string {
  const link = t.text('link', row);
  return link !== '' ? `${link} \u2013 ${t.text('object', row)}` : t.text('reason', row);
}

const kSearched = ['trial', 'controller', 'point', 'family', 'outcome', 'link', 'object', 'reason', 'store'];

const joined = new WeakMap<PageData['trials'], string[]>();

/** Search text of each row, in lower case; its world is "world:12". */
function textsOf({ page, trials: t }: Model): string[] {
  let texts = joined.get(page.trials);
  if (texts === undefined) {
    texts = Array.from({ length: t.n }, (_, row) => [...kSearched.map((name) => t.text(name, row)), `world:${t.number('world', row)}`].join('\n').toLowerCase());
    joined.set(page.trials, texts);
  }
  return texts;
}

let sorted: { of: View; by: string; rows: number[] } | null = null;

/** All rows of the shown series in the chosen order, those without a value last. */
function inOrder(model: Model): number[] {
  const now = view();
  const by = state.get('sort');
  if (sorted?.of === now && sorted.by === by) return sorted.rows;
  const [key = 'world', direction = 'up'] = by.split(':');
  const sign = direction === 'down' ? -1 : 1;
  const at = (row: number): string | number => {
    if (key === 'contact') return contact(model, row);
    if (isText(key)) return model.trials.text(key, row);
    const value = model.trials.number(key, row);
    return Number.isNaN(value) ? sign * Infinity : value;
  };
  const rows = now.series.flatMap((s) => s.rows.map((row) => ({ row, at: at(row) })));
  rows.sort((a, b) => (a.at === b.at ? 0 : a.at < b.at ? -sign : sign));
  sorted = { of: now, by, rows: rows.map(({ row }) => row) };
  return sorted.rows;
}

export function filtered(model: Model): number[] {
  const { trials: t } = model;
  const outcome = state.get('outcome');
  const who = state.get('who');
  const words = state.get('q').trim().toLowerCase().split(/\s+/).filter((word) => word !== '');
  const texts = words.length > 0 ? textsOf(model) : [];
  return inOrder(model).filter((row) => (outcome === '' || (outcome === 'failure' ? !t.success(row) : t.outcome(row) === outcome))
    && (who === '' || t.text('controller', row) === who) && words.every((word) => texts[row]?.includes(word)));
}
