// Paired comparison of two series on the worlds that both met.

import type { Model, Series } from './data';
import { fixed, integer, probability, signed } from './format';
import { withUnit, type Metric } from './metrics';
import { bootstrapMean, holm, pairedRate, type Interval, type PairedRate } from './stats';

/** Rows of the two trials, their metric. */
export interface PairedWorld { world: number; a: number; b: number; x: number; y: number }

export type Pairs = ReturnType<typeof pairs>;
export type Rates = ReturnType<typeof rates>;

/** `mean`: of B - A over the worlds in which both sides have the metric, so many `differences`. */
export function pairs(model: Model, a: Series, b: Series, key: string) {
  const t = model.trials;
  // Worlds are matched by content, not by index: compared stores can number them differently.
  const named = (row: number): string => t.text('world_key', row);
  const place = new Map(a.rows.map((row) => [named(row), row]));
  const worlds: PairedWorld[] = [];
  for (const row of b.rows) {
    const world = t.number('world', row);
    const other = place.get(named(row));
    if (other === undefined) continue;
    worlds.push({ world, a: other, b: row, x: t.number(key, other), y: t.number(key, row) });
  }
  const differences = worlds.filter((w) => Number.isFinite(w.x) && Number.isFinite(w.y)).map((w) => w.y - w.x);
  let interval: Interval | undefined;
  return {
    worlds, differences: differences.length,
    mean: differences.reduce((sum, d) => sum + d, 0) / differences.length,
    /** Of the mean; computed on request, since the bootstrap is slow. */
    get interval() { return interval ??= bootstrapMean(differences); },
  };
}

/**
 * Rates on the same worlds, as `moma compare` has them (eval/stats/comparison.h): an error is no success, and where there are
 * any, `sansErrors` is of the worlds without. `p`: of success, by Holm's correction over success and collision; `ahead`: the
 * sign of a significant difference, else 0.
 */
export function rates(model: Model, worlds: readonly PairedWorld[]) {
  const t = model.trials;
  const rate = (outcome: string, of = worlds) => {
    const count = (inA: boolean, inB: boolean): number => of.filter((w) => (t.outcome(w.a) === outcome) === inA && (t.outcome(w.b) === outcome) === inB).length;
    return { both: count(true, true), neither: count(false, false), ...pairedRate(count(true, false), count(false, true), of.length) };
  };
  const errors = (side: 'a' | 'b'): number => worlds.filter((w) => t.outcome(w[side]) === 'error').length;
  const sound = worlds.filter((w) => t.outcome(w.a) !== 'error' && t.outcome(w.b) !== 'error');
  const [success, collision] = [rate('success'), rate('collision')];
  const [p = 1] = holm([success.p, collision.p]);
  return {
    success, collision, p, ahead: p < 0.05 ? Math.sign(success.value) : 0,
    errorsA: errors('a'), errorsB: errors('b'), sansErrors: sound.length < worlds.length ? rate('success', sound) : null,
  };
}

/** "+34.0" */
export function points(value: number): string {
  return signed(100 * value, (v) => fixed(v, 1));
}

export function chance({ onlyA, onlyB }: PairedRate, p: number): string {
  return onlyA + onlyB === 0 ? 'no world differs' : probability(p);
}

/** Follows a sentence about success; '' without errors. */
export function errorsText({ success, errorsA, errorsB, sansErrors }: Rates, a: string, b: string): string {
  if (sansErrors === null) return '';
  const others = sansErrors.n === 0 ? '' : `; without these worlds the difference is ${points(sansErrors.value)} points (n = ${integer(sansErrors.n)}, ${chance(sansErrors, sansErrors.p)})`;
  return ` In ${integer(success.n - sansErrors.n)} of these worlds a trial ended by an error (${a} ${integer(errorsA)}, ${b} ${integer(errorsB)}), which is no success${others}.`;
}

/** Says in words how bootstrapMean() computes its interval. */
export const kMeanInterval = 'paired bootstrap, as in moma compare';

export function pairsText(of: Pairs, told: Rates, a: string, b: string, metric: Metric): string {
  const { n, both, onlyA, onlyB, neither, p } = told.success;
  const test = onlyA + onlyB === 0 ? 'no world tells them apart' : `exact McNemar ${probability(p)}`;
  const outcome = `n = ${integer(n)} worlds: both succeed in ${integer(both)}, only ${a} in ${integer(onlyA)}, only ${b} in ${integer(onlyB)}, neither in ${integer(neither)} (${test}).${errorsText(told, a, b)}`;
  if (of.differences === 0) return outcome;
  const interval = Number.isFinite(of.interval.low) ? `, 95 % interval ${metric.write(of.interval.low)} to ${withUnit(metric, of.interval.high)} (${kMeanInterval})` : ', no interval of so few';
  return `${outcome} Mean difference of ${metric.name}, ${b} less ${a}, where both have it (n = ${integer(of.differences)}): ${withUnit(metric, of.mean)}${interval}.`;
}
