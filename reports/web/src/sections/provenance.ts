// How the numbers came to be: runs, versions, machine, and the controllers' parameters side by side.

import { flatten } from '../conditions';
import { inSlice, type Model, type PointInfo } from '../data';
import { h, replace } from '../dom';
import { integer, plural } from '../format';
import { onView, view } from '../view';
import { changes } from './changes';

const kMost = 8;

interface Column { head: string; small: string; values: Map<string, string> }

/** A column per point; none twice. */
function columnsOf(points: readonly PointInfo[], what: (p: PointInfo) => unknown, head: (p: PointInfo) => [string, string]): Column[] {
  const columns = new Map<string, Column>();
  for (const p of points) {
    const [name, small] = head(p);
    const values = new Map(flatten(what(p)).filter(([key]) => key !== ''));
    columns.set([name, small, ...[...values].flat()].join('\n'), { head: name, small, values });
  }
  return [...columns.values()].slice(0, kMost);
}

function disturbances(points: readonly PointInfo[]): HTMLElement | null {
  if (points.every((p) => Object.keys(p.disturbances).length === 0)) return null;
  const labels = new Set(points.map((p) => p.point));
  // One column for all controllers where each sweep point has its own.
  const same = [...labels].every((label) => new Set(points.filter((p) => p.point === label).map((p) => JSON.stringify(p.disturbances))).size === 1);
  const shown = columnsOf(points, (p) => p.disturbances, (p) => (same ? [p.point || 'all points', ''] : [p.controller, p.point]));
  const keys = [...new Set(shown.flatMap((c) => [...c.values.keys()]))];
  return h('details', { open: true }, h('summary', null, 'Disturbances'), h('div', { class: 'scroll', tabindex: 0, role: 'region', 'aria-label': 'Disturbances' }, h('table', { class: 'plain' },
    h('thead', null, h('tr', null, h('th', { scope: 'col' }, 'Key'), ...shown.map((c) => h('th', { scope: 'col' }, c.head, c.small ? h('small', null, c.small) : null)))),
    h('tbody', null, ...keys.map((key) => h('tr', null, h('th', { scope: 'row' }, key), ...shown.map((c) => h('td', null, c.values.get(key) ?? 'off'))))))));
}

function parameters(all: readonly PointInfo[]): HTMLElement | null {
  // Where conditions alone are swept, a controller's points have the same parameters.
  const points = [...new Map(all.map((p) => [`${p.controller}\n${JSON.stringify(p.parameters)}`, p])).values()];
  const label = (p: PointInfo): string => (all.filter((o) => o.controller === p.controller).length > 1 && points.filter((o) => o.controller === p.controller).length === 1 ? '' : p.point);
  const shown = points.slice(0, kMost);
  const flat = shown.map((p) => new Map(flatten(p.parameters)));
  const keys = [...new Set(flat.flatMap((m) => [...m.keys()]))];
  if (keys.length === 0) return null;
  const differs = (key: string): boolean => new Set(flat.map((m) => m.get(key))).size > 1;
  const only = keys.filter(differs);
  const table = (names: readonly string[]): HTMLElement => h('div', { class: 'scroll', tabindex: 0, role: 'region', 'aria-label': 'Parameters' }, h('table', { class: 'plain' },
    h('thead', null, h('tr', null, h('th', { scope: 'col' }, 'Parameter'), ...shown.map((p) => h('th', { scope: 'col' }, p.controller, label(p) ? h('small', null, label(p)) : null)))),
    h('tbody', null, ...names.map((key) => h('tr', { class: differs(key) ? 'differs' : null }, h('th', { scope: 'row' }, key), ...flat.map((m) => h('td', null, m.get(key) ?? '\u2013')))))));
  return h('div', null,
    only.length > 0 && shown.length > 1 ? h('div', null, h('h3', null, 'Where the controllers differ'), table(only)) : null,
    h('details', null, h('summary', null, `All ${plural(keys.length, 'parameter')}`), table(keys)));
}

export function provenance(model: Model): HTMLElement {
  const box = h('div', { class: 'provenance' });
  const fill = (): void => {
    const { slice } = view();
    const runs = model.page.invocations.filter((i) => i.suite === slice.suite);
    const latest = runs[0];
    replace(box,
      latest === undefined ? null : h('div', { class: 'columns' },
        h('dl', null, ...([
          ['Command', latest.arguments.join(' ')],
          ['Started, ended', `${latest.started}, ${latest.ended ?? 'not recorded'} (${latest.status})`],
          ['Trials', `${integer(latest.trials_done)} computed, ${integer(latest.trials_present)} found already stored`],
          ['Machine', `${latest.host}: ${latest.cpu}, ${plural(latest.cpu_count, 'core')}, ${plural(latest.threads, 'thread')}; ${latest.os}`],
          ['moma', `${latest.moma_version}, commit ${latest.git_commit ?? 'unknown'}${latest.git_dirty ? ' with changes' : ''}, ${latest.build_type}`],
          ['Compiler', `${latest.compiler} ${latest.compiler_flags}`],
          ['Libraries', Object.entries(latest.libraries).map(([name, version]) => `${name} ${version}`).join(', ')],
          ['Store', `${model.page.store.file}, schema ${model.page.store.schema}`],
        ] as const).map(([name, value]) => h('div', null, h('dt', null, name), h('dd', null, value)))),
        runs.length > 1 ? h('div', null, h('h3', null, 'Earlier runs'), h('ul', null, ...runs.slice(1, 12).map((r) =>
          h('li', null, `${r.started}, ${r.host}, moma ${r.moma_version}: ${plural(r.trials_done, 'trial')}, ${r.status}`)))) : null),
      changes(model),
      disturbances(model.page.points.filter((p) => inSlice(p, slice))),
      parameters(model.page.points.filter((p) => inSlice(p, slice))));
    if (latest === undefined) replace(box, h('p', { class: 'empty' }, 'No run is recorded in this store.'));
  };
  fill();
  onView(fill);
  return box;
}
