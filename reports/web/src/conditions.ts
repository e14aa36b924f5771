// Conditions: swept disturbances, worlds, simulation. Controllers are compared under one condition, or
// one controller over several; none of them is "the best".

import type { Model, PointInfo, Slice } from './data';
import * as state from './state';

export interface Condition {
  key: string;
  /** Distinct values in the order of the points, as JSON. */
  values: string[];
}

/** Keys of a controller: their values are candidates to choose from. */
function isGain(key: string): boolean {
  return /^controllers?\./.test(key);
}

/** "../disturbances/realistic.yaml" -> "realistic"; maps are too long to be read. */
export function shortValue(json: string): string {
  const value = JSON.parse(json) as unknown;
  if (typeof value === 'string') return value.replace(/^.*\//, '').replace(/\.ya?ml$/, '');
  return json.length > 24 ? `${json.slice(0, 23)}\u2026` : json;
}

function valueOf(point: PointInfo, key: string): string {
  return JSON.stringify(point.params[key] ?? null);
}

export function conditions(model: Model, slice: Slice): Condition[] {
  const points = model.pointsOf(slice);
  const keys = [...new Set(points.flatMap((p) => Object.keys(p.params)))].filter((key) => !isGain(key));
  return keys.map((key) => ({ key, values: [...new Set(points.map((p) => valueOf(p, key)))] })).filter((c) => c.values.length > 1);
}

/** True if the points of a controller differ, and only in conditions. */
export function onlyConditions(model: Model, slice: Slice): boolean {
  return conditions(model, slice).length > 0 && !model.pointsOf(slice).some((p) => Object.keys(p.params).some(isGain));
}

/** The chosen value of each condition, by its place; kept in the address as "0.2,1.0". */
export function chosen(): Map<number, number> {
  return new Map(state.get('at').split(',').filter((text) => /^\d+\.\d+$/.test(text)).map((text) => text.split('.').map(Number) as [number, number]));
}

export function choose(place: number, value: number | undefined): void {
  const now = chosen();
  if (value === undefined) now.delete(place);
  else now.set(place, value);
  state.set({ at: [...now].map((pair) => pair.join('.')).join(','), show: '' });
}

export function meets(model: Model, slice: Slice, point: PointInfo): boolean {
  if (state.get('at') === '') return true;
  const now = chosen();
  return conditions(model, slice).every((c, place) => {
    const value = c.values[now.get(place) ?? -1];
    return value === undefined || valueOf(point, c.key) === value;
  });
}

/** True if two points have the same conditions and disturbances. A condition that no point names is the same. */
export function equalConditions(model: Model, slice: Slice, a: PointInfo, b: PointInfo): boolean {
  const disturbedBy = (point: PointInfo): string => JSON.stringify(Object.entries(point.disturbances ?? {}).filter(([key]) => key !== 'seed'));
  return disturbedBy(a) === disturbedBy(b) && conditions(model, slice).every((c) => valueOf(a, c.key) === valueOf(b, c.key));
}

/** {"collision": {"stop": 1}} -> [["collision.stop", "1"]]. */
export function flatten(value: unknown, prefix = ''): [string, string][] {
  if (value !== null && typeof value === 'object' && !Array.isArray(value)) {
    return Object.entries(value).flatMap(([key, inner]) => flatten(inner, prefix === '' ? key : `${prefix}.${key}`));
  }
  return [[prefix, typeof value === 'string' ? value : JSON.stringify(value)]];
}

/** "joints, base, goal": what of a point is disturbed; '' nothing. */
export function disturbed(point: PointInfo | undefined): string {
  return Object.keys(point?.disturbances ?? {}).filter((key) => key !== 'seed').join(', ');
}

/** Names the disturbed parts of a slice's points in a few words; '' without disturbances. */
export function disturbances(model: Model, slice: Slice): string {
  const points = model.pointsOf(slice);
  const swept = conditions(model, slice).filter((c) => c.key === 'disturbances');
  if (swept.length > 0) return swept.flatMap((c) => c.values.map(shortValue)).join(', ');
  const kinds = new Set(points.map(disturbed));
  return kinds.size > 1 ? 'differ from point to point' : [...kinds][0] ?? '';
}
