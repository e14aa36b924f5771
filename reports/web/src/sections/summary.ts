// The table of the store's v_summary: one row per controller and family.

import { onlyConditions } from '../conditions';
import { inSlice, type Model, type SummaryRow } from '../data';
import { download, h, replace, roving } from '../dom';
import { csv, integer, percent, percentRange, seconds, significant } from '../format';
import { axisName, kMetrics, type Metric } from '../metrics';
import * as state from '../state';
import { onTheme, palette, seriesColour } from '../theme';
import { onView, view } from '../view';

function rows(model: Model): SummaryRow[] {
  const { slice, family, families } = view();
  const all = [...model.page.summary, ...model.page.overall].filter((s) => inSlice(s, slice));
  return all.filter((s) => (s.family === null ? family === '' && families.length > 1 : family === '' || s.family === family));
}

function rate(value: number, low: number, high: number): Node[] {
  return [h('b', null, percent(value)), h('span', { class: 'ci' }, percentRange(low, high))];
}

type Head = readonly [name: string, detail: string, key: string, first: 'up' | 'down'];
const kHead: readonly Head[] = [
  ['Controller', '', 'controller', 'up'], ['n', 'trials', 'n', 'down'], ['Success', 'rate, 95 % Wilson', 'success_rate', 'down'], ['Collision', 'rate, 95 % Wilson', 'collision_rate', 'up'],
  ['Time to goal', 'median of successes', 'time_to_goal_median_s', 'up'], ['Manipulability', 'mean', 'manip_mean', 'down'], ['Clearance', 'mean of least', 'clearance_min_m', 'down'],
  ['Command change', 'mean, share of limit', 'command_change_mean', 'up'],
];

/** The suites' own metrics that rows have. */
function ownMetrics(all: readonly SummaryRow[]): Metric[] {
  return kMetrics.filter((m) => m.own && all.some((r) => r.own?.[m.key] !== undefined));
}

function cellOf(row: SummaryRow, key: string): string | number | null {
  const own = row.own?.[key];
  return own === undefined ? (row as unknown as Record<string, string | number | null>)[key] ?? null : own;
}

/** More rows than this in a group are in the order of their success, unless another is asked for. */
const kAsDefined = 4;

/** In the order asked for; rows without the value last. */
function ordered(group: readonly SummaryRow[]): SummaryRow[] {
  const asked = state.get('rank') || (group.length > kAsDefined ? 'success_rate:down' : '');
  const [key = '', direction] = asked.split(':');
  if (![...kHead.map((head) => head[2]), ...ownMetrics(group).map((m) => m.key)].includes(key)) return [...group];
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
    const groups = new Map<string, SummaryRow[]>();
    const listed = rows(model);
    const own = ownMetrics(listed);
    const heads: readonly Head[] = [...kHead, ...own.map((m): Head => [axisName(m), 'mean, of the suite\u2019s own', m.key, 'down'])];
    for (const row of listed) {
      const family = row.family ?? 'all families';
      groups.set(family, [...(groups.get(family) ?? []), row]);
    }
    const rivals = (group: SummaryRow[], row: SummaryRow): SummaryRow[] => (within ? group.filter((r) => r.point === row.point) : group);
    const best = (group: SummaryRow[], row: SummaryRow): boolean => row.n > 0 && rivals(group, row).length > 1 && rivals(group, row).every((r) => r.n === 0 || r.success_rate <= row.success_rate);
    replace(body, h('table', { class: 'summary' },
      h('thead', null, h('tr', null, ...heads.map(([name, detail, key, first], i) => {
        const [by, direction] = state.get('rank').split(':');
        const next = by === key ? (direction === first ? (first === 'up' ? 'down' : 'up') : '') : first;
        return h('th', { scope: 'col', class: i === 0 ? 'text' : 'num', 'aria-sort': by === key ? (direction === 'down' ? 'descending' : 'ascending') : null },
          h('button', { type: 'button', class: 'sorter', click: () => { state.set({ rank: next === '' ? '' : `${key}:${next}` }); fill(); } }, name, by === key ? (direction === 'down' ? ' \u2193' : ' \u2191') : ''),
          detail ? h('small', null, detail) : null);
      }))),
      ...[...groups].map(([family, group]) => h('tbody', null,
        h('tr', { class: 'group' }, h('th', { colspan: heads.length, scope: 'rowgroup' }, family)),
        ...ordered(group).map((r) => {
          const series = all.find((s) => s.controller === r.controller && s.point === r.point);
          return h('tr', { class: best(group, r) ? 'best' : null },
            h('th', { scope: 'row', class: 'text' }, h('span', { class: 'dotted', style: `--c:${seriesColour(palette(), series?.mark ?? -1)}` }, r.controller), r.point ? h('small', null, r.point) : null),
            h('td', { class: 'num' }, integer(r.n), r.errors === 0 ? null : h('small', { class: 'errors' }, `with ${r.errors === 1 ? 'one error' : `${integer(r.errors)} errors`}`)),
            h('td', { class: 'num' }, ...rate(r.success_rate, r.success_low, r.success_high), r.errors === 0 ? null : h('small', { class: 'errors' }, r.success_without_errors === null ? 'nothing but errors' : `${percent(r.success_without_errors)} without errors`)),
            h('td', { class: 'num' }, ...rate(r.collision_rate, r.collision_low, r.collision_high)),
            h('td', { class: 'num' }, seconds(r.time_to_goal_median_s)),
            h('td', { class: 'num' }, significant(r.manip_mean)),
            h('td', { class: 'num' }, r.clearance_min_m === null ? '\u2013' : `${significant(r.clearance_min_m)}\u00a0m`),
            h('td', { class: 'num' }, significant(r.command_change_mean)),
            ...own.map((m) => h('td', { class: 'num' }, significant(r.own?.[m.key]))));
        })))));
    if (groups.size === 0) replace(body, h('p', { class: 'empty' }, 'No trial here has a result.'));
  };
  fill();
  onView(fill);
  onTheme(fill);
  const save = (): void => {
    const all = rows(model);
    const columns = [...Object.keys(all[0] ?? {}).filter((c) => c !== 'own'), ...ownMetrics(all).map((m) => m.key)];
    download('summary.csv', 'text/csv', csv(columns, all.map((r) => columns.map((c) => cellOf(r, c)))));
  };
  return h('div', { class: 'panel' }, body,
    h('footer', null, h('p', { class: 'note' }, 'As the store\u2019s view v_summary has it; bold: the greatest success rate of its group. Means are over the trials that have the value. A trial that ended in a program error did not succeed, and is part of no mean; where there are such trials, the rate without them stands below.'),
      h('div', { class: 'actions' }, h('button', { type: 'button', class: 'quiet', click: save }, 'Data CSV'))));
}
