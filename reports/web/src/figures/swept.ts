// The points of a sweep: what was swept, and the measure that is looked at.

import { inSlice, type Model, type SummaryRow } from '../data';
import { choice } from '../dom';
import { fixed, percent, percentRange, seconds, significant } from '../format';
import * as state from '../state';
import type { Palette } from '../theme';
import { view } from '../view';

export interface Point {
  name: string;
  controller: string;
  point: string;
  values: Map<string, number>;
  row: SummaryRow;
}

export interface Measure {
  key: keyof SummaryRow;
  name: string;
  write: (v: number) => string;
  lowIsGood: boolean;
  /** The same of one trial: a metric, or whether it ended so. */
  trial: { metric: string } | { outcome: string };
}

const kMeasures: readonly Measure[] = [
  { key: 'success_rate', name: 'success rate', write: (v) => percent(v), lowIsGood: false, trial: { outcome: 'success' } },
  { key: 'collision_rate', name: 'collision rate', write: (v) => percent(v), lowIsGood: true, trial: { outcome: 'collision' } },
  { key: 'time_to_goal_median_s', name: 'median time to goal', write: (v) => seconds(v), lowIsGood: true, trial: { metric: 'time_to_goal_s' } },
  { key: 'manip_mean', name: 'mean manipulability', write: (v) => fixed(v, 4), lowIsGood: false, trial: { metric: 'manip_mean' } },
  { key: 'clearance_min_m', name: 'mean least clearance', write: (v) => `${fixed(v, 3)} m`, lowIsGood: false, trial: { metric: 'clearance_min_m' } },
  { key: 'command_change_mean', name: 'mean command change', write: (v) => significant(v), lowIsGood: true, trial: { metric: 'command_change_mean' } },
];

/** The points of the slice with the numbers that were swept, and their rows of the summary. */
export function points(model: Model): Point[] {
  const { slice, family } = view();
  const rows = (family === '' ? model.page.overall : model.page.summary.filter((s) => s.family === family)).filter((r) => inSlice(r, slice));
  return model.page.points.filter((p) => inSlice(p, slice)).flatMap((p) => {
    const values = new Map(Object.entries(p.params).filter((e): e is [string, number] => typeof e[1] === 'number'));
    const row = rows.find((r) => r.controller === p.controller && r.point === p.point);
    return values.size === 0 || row === undefined ? [] : [{ name: p.point || p.controller, controller: p.controller, point: p.point, values, row }];
  });
}

/** Gains with more than one value. */
export function gains(all: readonly Point[]): string[] {
  const keys = [...new Set(all.flatMap((p) => [...p.values.keys()]))];
  return keys.filter((key) => new Set(all.map((p) => p.values.get(key))).size > 1);
}

export function measure(): Measure {
  return kMeasures.find(({ key }) => key === state.get('f.measure')) ?? kMeasures[0]!;
}

/** NaN where the point has none. */
export function valueOf(point: Point, of: Measure): number {
  const value = point.row[of.key];
  return typeof value === 'number' ? value : NaN;
}

/** The 95 % interval of a rate; null of other measures. */
export function intervalOf(point: Point, of: Measure): [number, number] | null {
  const r = point.row;
  return of.key === 'success_rate' ? [r.success_low, r.success_high] : of.key === 'collision_rate' ? [r.collision_low, r.collision_high] : null;
}

export function isBetter(a: number, b: number, of: Measure): boolean {
  return of.lowIsGood ? a < b : a > b;
}

/** What a point's tooltip says. */
export function told(point: Point, of: Measure): [string, string][] {
  const r = point.row;
  return [[of.name, of.write(valueOf(point, of))], ['success', `${percent(r.success_rate)} (${percentRange(r.success_low, r.success_high)})`], ['n', String(r.n)]];
}

export function ramp(p: Palette): string[] {
  return p.dark ? ['#1d2733', '#24496b', '#3b7fae', '#7fc0d8', '#e8f3e2'] : ['#f3f1ea', '#c9dbe2', '#86b3c9', '#41799f', '#173d63'];
}

export function short(key: string): string {
  return key.replace(/^controllers?\./, '');
}

export function isSwept(model: Model): boolean {
  return model.page.points.some((p) => Object.values(p.params).some((v) => typeof v === 'number'));
}

export function measureChoice(redraw: () => void): Node {
  return choice('Measure', kMeasures.map(({ key, name }) => [key, name] as const), state.get('f.measure'), (value) => { state.set({ 'f.measure': value }); redraw(); });
}
