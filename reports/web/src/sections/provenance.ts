// How the numbers came to be: runs, versions, machine, and the controllers' parameters side by side.

import { inSlice, type Model, type PointInfo } from '../data';
import { h, replace } from '../dom';
import { integer, plural } from '../format';
import { onView, view } from '../view';

/** {"collision": {"stop": 1}} -> [["collision.stop", "1"]]. */
function flatten(value: unknown, prefix = ''): [string, string][] {
  if (value !== null && typeof value === 'object' && !Array.isArray(value)) {
    return Object.entries(value).flatMap(([key, inner]) => flatten(inner, prefix === '' ? key : `${prefix}.${key}`));
  }
  return [[prefix, typeof value === 'string' ? value : JSON.stringify(value)]];
}

function parameters(points: readonly PointInfo[]): HTMLElement | null {
  const shown = points.slice(0, 8);
  const flat = shown.map((p) => new Map(flatten(p.parameters)));
  const keys = [...new Set(flat.flatMap((m) => [...m.keys()]))];
  if (keys.length === 0) return null;
  const differs = (key: string): boolean => new Set(flat.map((m) => m.get(key))).size > 1;
  const only = keys.filter(differs);
  const table = (names: readonly string[]): HTMLElement => h('div', { class: 'scroll', tabindex: 0, role: 'region', 'aria-label': 'Parameters' }, h('table', { class: 'plain' },
    h('thead', null, h('tr', null, h('th', { scope: 'col' }, 'Parameter'), ...shown.map((p) => h('th', { scope: 'col' }, p.controller, p.point ? h('small', null, p.point) : null)))),
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
      parameters(model.page.points.filter((p) => inSlice(p, slice))));
    if (latest === undefined) replace(box, h('p', { class: 'empty' }, 'No run is recorded in this store.'));
  };
  fill();
  onView(fill);
  return box;
}
