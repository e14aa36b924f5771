// Provenance of the numbers: runs, versions, machine, what changed, and the controllers' parameters side by side.

import { flatten } from '../conditions';
import type { Model, PointInfo } from '../data';
import { h, replace, table, terms } from '../dom';
import { integer, plural } from '../format';
import * as state from '../state';
import { kView, view } from '../view';
import { kSettings } from './notices';

/** More columns than this are not read. */
const kMost = 8;
/** More differences than these of one pair are told in number only. */
const kMostChanges = 12;

interface Column { head: string; small: string; values: Map<string, string> }

/** Values by key, a column for each of the first few points or controllers. */
function sideBySide(label: string, keys: readonly string[], columns: readonly Column[], none: string): HTMLElement {
  return table(label, [label.replace(/s$/, ''), ...columns.map((c) => [c.head, c.small === '' ? null : h('small', null, c.small)])], keys.map((key) => [key, ...columns.map((c) => c.values.get(key) ?? none)]));
}

function keysOf(columns: readonly Column[]): string[] {
  return [...new Set(columns.flatMap((c) => [...c.values.keys()]))];
}

function disturbances(points: readonly PointInfo[]): HTMLElement | null {
  if (points.every((p) => Object.keys(p.disturbances).length === 0)) return null;
  const labels = new Set(points.map((p) => p.point));
  // One column for all controllers where each sweep point has its own.
  const same = [...labels].every((label) => new Set(points.filter((p) => p.point === label).map((p) => JSON.stringify(p.disturbances))).size === 1);
  const columns = new Map<string, Column>();   // none twice
  for (const p of points) {
    const column = { head: same ? p.point || 'all points' : p.controller, small: same ? '' : p.point, values: new Map(flatten(p.disturbances).filter(([key]) => key !== '')) };
    columns.set(JSON.stringify([column.head, column.small, ...column.values]), column);
  }
  const shown = [...columns.values()].slice(0, kMost);
  return h('details', { open: true }, h('summary', null, 'Disturbances'), sideBySide('Disturbances', keysOf(shown), shown, 'off'));
}

function parameters(all: readonly PointInfo[]): HTMLElement | null {
  // If conditions alone are swept, a controller's points have the same parameters.
  const points = [...new Map(all.map((p) => [`${p.controller}\n${JSON.stringify(p.parameters)}`, p])).values()];
  const count = (among: readonly PointInfo[], p: PointInfo): number => among.filter((o) => o.controller === p.controller).length;
  const shown = points.slice(0, kMost).map((p): Column => ({ head: p.controller, small: count(all, p) > 1 && count(points, p) === 1 ? '' : p.point, values: new Map(flatten(p.parameters)) }));
  const keys = keysOf(shown);
  if (keys.length === 0) return null;
  const only = keys.filter((key) => new Set(shown.map((c) => c.values.get(key))).size > 1);
  return h('div', null,
    only.length > 0 && shown.length > 1 ? h('div', null, h('h3', null, 'Where the controllers differ'), sideBySide('Parameters', only, shown, '\u2013')) : null,
    h('details', null, h('summary', null, `All ${plural(keys.length, 'parameter')}`), sideBySide('Parameters', keys, shown, '\u2013')));
}

/** Settings of a point other than its gains. */
const kShared: readonly (keyof PointInfo)[] = [...kSettings.map(([key]) => key), 'simulation_version', 'disturbances', 'worlds', 'robot_content'];

function settingsOf(p: PointInfo): Map<string, string> {
  return new Map([...flatten(p.parameters), ...kShared.flatMap((key) => flatten(p[key], key))].filter(([key]) => key !== ''));
}

/** "mine@2 (after)" and "mine (before)" are versions of one controller. */
function lineage({ controller, store }: PointInfo): string {
  const ofStore = ` (${store})`;
  return (controller.endsWith(ofStore) ? controller.slice(0, -ofStore.length) : controller).replace(/@\d+$/, '');
}

/** Each version of a controller at a sweep point, the one before it, and the settings in which they differ, gains first. */
export function changesOf(points: readonly PointInfo[]): { now: PointInfo; before: PointInfo; differs: string[] }[] {
  const last = new Map<string, PointInfo>();
  return points.flatMap((now) => {
    const key = JSON.stringify([lineage(now), now.point]);
    const before = last.get(key);
    last.set(key, now);
    if (before === undefined) return [];
    const [from, to] = [settingsOf(before), settingsOf(now)];
    const keys = [...new Set([...from.keys(), ...to.keys()])].filter((name) => from.get(name) !== to.get(name));
    return [{ now, before, differs: keys.map((name) => `${name}: ${from.get(name) ?? 'not set'} \u2192 ${to.get(name) ?? 'not set'}`) }];
  });
}

/** A line for each version of a controller against the one before it; null where there is one of each. */
function changes(points: readonly PointInfo[]): HTMLElement | null {
  const lines = changesOf(points).map(({ now, before, differs }) => {
    const more = differs.length > kMostChanges ? `, and ${differs.length - kMostChanges} more` : '';
    return h('li', null, h('b', null, now.controller), differs.length === 0 ? ` has the settings of ${before.controller}.` : ` differs from ${before.controller} in ${differs.slice(0, kMostChanges).join('; ')}${more}.`);
  });
  return lines.length === 0 ? null : h('div', { class: 'changes' }, h('h3', null, 'What changed'), h('ul', null, ...lines));
}

export function provenance(model: Model): HTMLElement {
  const box = h('div', { class: 'provenance' });
  const fill = (): void => {
    const { slice } = view();
    const [latest, ...earlier] = model.page.invocations.filter((i) => i.suite === slice.suite);
    if (latest === undefined) {
      replace(box, h('p', { class: 'empty' }, 'No run is recorded in this store.'));
      return;
    }
    const points = model.pointsOf(slice);
    replace(box,
      h('div', { class: 'columns' },
        h('dl', null, ...terms([
          ['Command', latest.arguments.join(' ')],
          ['Started, ended', `${latest.started}, ${latest.ended ?? 'not recorded'} (${latest.status})`],
          ['Trials', `${integer(latest.trials_done)} computed, ${integer(latest.trials_present)} found already stored`],
          ['Machine', `${latest.host}: ${latest.cpu}, ${plural(latest.cpu_count, 'core')}, ${plural(latest.threads, 'thread')}; ${latest.os}`],
          ['moma', `${latest.moma_version}, commit ${latest.git_commit ?? 'unknown'}${latest.git_dirty ? ' with changes' : ''}, ${latest.build_type}`],
          ['Compiler', `${latest.compiler} ${latest.compiler_flags}`],
          ['Libraries', Object.entries(latest.libraries).map(([name, version]) => `${name} ${version}`).join(', ')],
          ['Store', `${model.page.store.file}, schema ${model.page.store.schema}`],
        ])),
        earlier.length > 0 ? h('div', null, h('h3', null, 'Earlier runs'), h('ul', null, ...earlier.slice(0, 11).map((r) =>
          h('li', null, `${r.started}, ${r.host}, moma ${r.moma_version}: ${plural(r.trials_done, 'trial')}, ${r.status}`)))) : null),
      changes(points), disturbances(points), parameters(points));
  };
  fill();
  state.listen(kView, fill);
  return box;
}
