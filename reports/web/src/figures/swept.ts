// The points of a sweep: what was swept, and the measure that is looked at.

import type { Choice } from '../chart';
import { cellOf, type Model, type SummaryRow } from '../data';
import { percent, percentRange } from '../format';
import { kMetrics, withUnit } from '../metrics';
import * as state from '../state';
import { resultOf, view } from '../view';

export interface Point { name: string; values: Map<string, number>; row: SummaryRow }

export interface Measure {
  /** Column of the table of results. */
  key: string;
  name: string; write: (v: number) => string; lowIsGood: boolean;
}

/** Measures of a point in the table of results: rates, and the shown metrics. */
export function measures(): Measure[] {
  return [
    { key: 'success_rate', name: 'success rate', write: percent, lowIsGood: false },
    { key: 'collision_rate', name: 'collision rate', write: percent, lowIsGood: true },
    ...kMetrics.flatMap((m) => (m.summary === undefined ? [] : [{ key: m.summary.column, name: m.summary.name, write: (v: number) => withUnit(m, v), lowIsGood: m.better === 'low' }])),
  ];
}

export function measure(): Measure {
  const all = measures();
  return all.find(({ key }) => key === state.get('f.measure')) ?? all[0]!;
}

export const kMeasureChoice: Choice = { key: 'f.measure', label: 'Measure', options: () => measures().map(({ key, name }) => [key, name] as const), value: () => measure().key };

/** The points of the slice with the numbers that were swept, and their rows of the table of results. */
export function points(): Point[] {
  const { model, slice } = view();
  return model.pointsOf(slice).flatMap((p) => {
    const values = new Map(Object.entries(p.params).filter((e): e is [string, number] => typeof e[1] === 'number'));
    const row = resultOf(p);
    return values.size === 0 || row === undefined ? [] : [{ name: p.point || p.controller, values, row }];
  });
}

export function measured(): Point[] {
  const of = measure();
  return points().filter((point) => Number.isFinite(valueOf(point.row, of)));
}

export function gains(all: readonly Point[]): string[] {
  const keys = [...new Set(all.flatMap((p) => [...p.values.keys()]))];
  return keys.filter((key) => new Set(all.map((p) => p.values.get(key))).size > 1);
}

/** Value of the measure; NaN without one. */
export function valueOf(row: SummaryRow, of: Measure): number {
  const value = cellOf(row, of.key);
  return typeof value === 'number' ? value : NaN;
}

/** The 95 % interval of a rate; null of other measures. */
export function intervalOf(r: SummaryRow, of: Measure): [number, number] | null {
  return of.key === 'success_rate' ? [r.success_low, r.success_high] : of.key === 'collision_rate' ? [r.collision_low, r.collision_high] : null;
}

export function isBetter(a: number, b: number, of: Measure): boolean {
  return of.lowIsGood ? a < b : a > b;
}

export function told({ row }: Point, of: Measure): [string, string][] {
  return [[of.name, of.write(valueOf(row, of))], ['success', `${percent(row.success_rate)} (${percentRange(row.success_low, row.success_high)})`], ['n', String(row.n)]];
}

/** A gain's key without what it is of. */
export function short(key: string): string {
  return key.replace(/^controllers?\./, '');
}

export function isSwept(model: Model): boolean {
  return model.page.points.some((p) => Object.values(p.params).some((v) => typeof v === 'number'));
}
