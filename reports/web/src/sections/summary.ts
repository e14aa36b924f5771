// The table of the store's v_summary: one row per controller and family.

import { onlyConditions } from '../conditions';
import { cellOf, grouped, inSlice, type Model, type SummaryRow } from '../data';
import { dotted, h, replace, roving, type Child } from '../dom';
import { integer, percent, percentRange, significant, upper } from '../format';
import { kMetrics } from '../metrics';
import { footer, keepFilled, saveCsv } from '../panel';
import * as state from '../state';
import { palette, seriesColour } from '../theme';
import { view } from '../view';

function rows(model: Model): SummaryRow[] {
  const { slice, family, families } = view();
  const all = [...model.page.summary, ...model.page.overall].filter((s) => inSlice(s, slice));
  return all.filter((s) => (s.family === null ? family === '' && families.length > 1 : family === '' || s.family === family));
}

/** A column of numbers: its head, what stands below it, and a row's cell. `lowFirst`: a first click sorts from below. */
interface Column { key: string; head: string; detail: string; lowFirst: boolean; cell: (row: SummaryRow) => Child[] }

function rate(name: 'success' | 'collision', more: (row: SummaryRow) => Child = () => null): Column {
  return {
    key: `${name}_rate`, head: upper(name), detail: 'rate, 95 % Wilson', lowFirst: name === 'collision',
    cell: (row) => [h('b', null, percent(row[`${name}_rate`])), h('span', { class: 'ci' }, percentRange(row[`${name}_low`], row[`${name}_high`])), more(row)],
  };
}

/** Trials and rates, then the metrics that the rows have: moma's, and the suites' own. */
function columns(all: readonly SummaryRow[]): Column[] {
  const errors = (row: SummaryRow, text: string): Child => (row.errors === 0 ? null : h('small', { class: 'errors' }, text));
  const number = (row: SummaryRow, key: string, write: (v: number) => string): string => { const value = cellOf(row, key); return typeof value === 'number' ? write(value) : significant(null); };
  return [
    { key: 'n', head: 'n', detail: 'trials', lowFirst: false, cell: (row) => [integer(row.n), errors(row, `with ${row.errors === 1 ? 'one error' : `${integer(row.errors)} errors`}`)] },
    rate('success', (row) => errors(row, row.success_without_errors === null ? 'nothing but errors' : `${percent(row.success_without_errors)} without errors`)),
    rate('collision'),
    ...kMetrics.flatMap((m): Column[] => (m.summary === undefined ? [] : [{ key: m.summary.column, head: upper(m.summary.name), detail: m.unit, lowFirst: m.better === 'low', cell: (row) => [number(row, m.summary?.column ?? '', m.write)] }])),
    ...kMetrics.filter((m) => m.own && all.some((row) => row.own?.[m.key] !== undefined))
      .map((m): Column => ({ key: m.key, head: m.name, detail: 'mean, of the suite\u2019s own', lowFirst: false, cell: (row) => [number(row, m.key, (v) => significant(v))] })),
  ];
}

/** More rows than this in a group are in the order of their success, unless another is asked for. */
const kAsDefined = 4;

/** Sorts the rows as asked; rows without the value come last. */
function ordered(group: readonly SummaryRow[], keys: readonly string[]): SummaryRow[] {
  const asked = state.get('rank') || (group.length > kAsDefined ? 'success_rate:down' : '');
  const [key = '', direction] = asked.split(':');
  if (!keys.includes(key)) return [...group];
  const sign = direction === 'down' ? -1 : 1;
  return [...group].sort((a, b) => {
    const [x, y] = [cellOf(a, key), cellOf(b, key)];
    if (x === null || y === null) return x === y ? 0 : x === null ? 1 : -1;
    if (typeof x === 'string' || typeof y === 'string') return sign * `${x} ${a.point}`.localeCompare(`${y} ${b.point}`, 'en', { numeric: true });
    return sign * (x - y);
  });
}

export function summary(model: Model): HTMLElement {
  const body = roving(h('div', { class: 'scroll', tabindex: 0, role: 'region', 'aria-label': 'Table of results' }), 'button');
  const fill = (): void => {
    const { all, slice } = view();
    const within = onlyConditions(model, slice);   // the best of each condition
    const listed = rows(model);
    const groups = grouped(listed, (row) => row.family ?? 'all families');
    const shown = columns(listed);
    const isBest = (group: SummaryRow[], row: SummaryRow): boolean => {
      const rivals = within ? group.filter((r) => r.point === row.point) : group;
      return row.n > 0 && rivals.length > 1 && rivals.every((r) => r.n === 0 || r.success_rate <= row.success_rate);
    };
    const [by, direction] = state.get('rank').split(':');
    const head = ({ key, head: name, detail, lowFirst }: Omit<Column, 'cell'>, align: string): HTMLElement => {
      const [first, second] = lowFirst ? ['up', 'down'] : ['down', 'up'];
      const next = by !== key ? first : direction === first ? second : '';
      return h('th', { scope: 'col', class: align, 'aria-sort': by === key ? (direction === 'down' ? 'descending' : 'ascending') : null },
        h('button', { type: 'button', class: 'sorter', click: () => { state.set({ rank: next === '' ? '' : `${key}:${next}` }); fill(); } }, name, by === key ? (direction === 'down' ? ' \u2193' : ' \u2191') : ''),
        detail ? h('small', null, detail) : null);
    };
    if (groups.size === 0) {
      replace(body, h('p', { class: 'empty' }, 'No trial here has a result.'));
      return;
    }
    replace(body, h('table', { class: 'summary' },
      h('thead', null, h('tr', null, head({ key: 'controller', head: 'Controller', detail: '', lowFirst: true }, 'text'), ...shown.map((column) => head(column, 'num')))),
      ...[...groups].map(([family, group]) => h('tbody', null,
        h('tr', { class: 'group' }, h('th', { colspan: shown.length + 1, scope: 'rowgroup' }, family)),
        ...ordered(group, ['controller', ...shown.map(({ key }) => key)]).map((row) => {
          const mark = all.find((s) => s.controller === row.controller && s.point === row.point)?.mark ?? -1;
          return h('tr', { class: isBest(group, row) ? 'best' : null },
            h('th', { scope: 'row', class: 'text' }, dotted(seriesColour(palette(), mark), row.controller), row.point ? h('small', null, row.point) : null),
            ...shown.map(({ cell }) => h('td', { class: 'num' }, ...cell(row))));
        })))));
  };
  keepFilled(fill);
  const saveButton = saveCsv('summary', () => {
    const all = rows(model);
    const keys = [...Object.keys(all[0] ?? {}).filter((key) => key !== 'own'), ...kMetrics.filter((m) => m.own).map((m) => m.key)];
    return { columns: keys, rows: all.map((row) => keys.map((key) => cellOf(row, key))) };
  });
  return h('div', { class: 'panel' }, body,
    footer(h('p', { class: 'note' }, 'As the store\u2019s view v_summary has it; bold: the greatest success rate of its group. The median time is over successes, means are over the trials that have the value. A trial that ended in a program error did not succeed, and is part of no mean; where there are such trials, the rate without them stands below.'), saveButton));
}
