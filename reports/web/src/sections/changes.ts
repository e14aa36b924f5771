// What changed from one store, or one version of a controller, to the next: setting by setting.

import { flatten } from '../conditions';
import { inSlice, type Model, type PointInfo } from '../data';
import { h } from '../dom';
import { view } from '../view';

/** "mine@2 (after)" and "mine (before)" are versions of one controller. */
export function lineage(point: Pick<PointInfo, 'controller' | 'store'>): string {
  const store = point.store === undefined ? '' : ` (${point.store})`;
  const name = store !== '' && point.controller.endsWith(store) ? point.controller.slice(0, -store.length) : point.controller;
  return name.replace(/@\d+$/, '');
}

const kSettings = ['mode', 'control_period_s', 'physics_step_s', 'time_limit_s', 'success_position_m', 'success_orientation_rad', 'success_dwell_s', 'simulation_version', 'disturbances', 'worlds'] as const;

function settings(point: PointInfo): Map<string, string> {
  const own = flatten(point.parameters);
  const shared = kSettings.flatMap((key) => flatten(point[key], key));
  return new Map([...own, ...shared].filter(([key]) => key !== ''));
}

/** "lambda_q: 0.01 → 0.02" for everything in which the second differs from the first. */
export function differences(a: PointInfo, b: PointInfo): string[] {
  const [from, to] = [settings(a), settings(b)];
  return [...new Set([...from.keys(), ...to.keys()])].filter((key) => from.get(key) !== to.get(key))
    .map((key) => `${key}: ${from.get(key) ?? 'not set'} \u2192 ${to.get(key) ?? 'not set'}`);
}

/** More than these of one pair are told in number only. */
const kMost = 12;

/** A line for each version of a controller against the one before it; null where there is one of each. */
export function changes(model: Model): HTMLElement | null {
  const points = model.page.points.filter((p) => inSlice(p, view().slice));
  const lines: HTMLElement[] = [];
  const before = new Map<string, PointInfo>();
  for (const point of points) {
    const key = `${lineage(point)}\n${point.point}`;
    const last = before.get(key);
    before.set(key, point);
    if (last === undefined) continue;
    const found = differences(last, point);
    const more = found.length > kMost ? `, and ${found.length - kMost} more` : '';
    lines.push(h('li', null, h('b', null, point.controller), found.length === 0 ? ` has the settings of ${last.controller}.` : ` differs from ${last.controller} in ${found.slice(0, kMost).join('; ')}${more}.`));
  }
  return lines.length === 0 ? null : h('div', { class: 'changes' }, h('h3', null, 'What changed'), h('ul', null, ...lines));
}
