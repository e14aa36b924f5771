// Paired comparison of two series on the worlds that both met.

import type { Model, Series } from './data';
import { integer, probability } from './format';
import { withUnit, type Metric } from './metrics';
import { bootstrapMean, mcnemar, type Interval } from './stats';

/** Rows of the two trials, their metric. */
export interface PairedWorld { world: number; a: number; b: number; x: number; y: number }

export type Pairs = ReturnType<typeof pairs>;

/** `p`: exact McNemar test of equal success rates. `mean`: of B - A over the worlds in which both sides have the metric, so many `differences`. */
export function pairs(model: Model, a: Series, b: Series, key: string) {
  const t = model.trials;
  // Worlds are matched by content, not by index: compared stores can number them differently.
  const named = (row: number): string => t.text('world_key', row);
  const place = new Map(a.rows.map((row) => [named(row), row]));
  const worlds: PairedWorld[] = [];
  const count = { both: 0, onlyA: 0, onlyB: 0, neither: 0 };
  for (const row of b.rows) {
    const world = t.number('world', row);
    const other = place.get(named(row));
    if (other === undefined) continue;
    worlds.push({ world, a: other, b: row, x: t.number(key, other), y: t.number(key, row) });
    const [sa, sb] = [t.success(other), t.success(row)];
    count[sa && sb ? 'both' : sa ? 'onlyA' : sb ? 'onlyB' : 'neither'] += 1;
  }
  const differences = worlds.filter((w) => Number.isFinite(w.x) && Number.isFinite(w.y)).map((w) => w.y - w.x);
  let interval: Interval | undefined;
  return {
    worlds, ...count, p: mcnemar(count.onlyA, count.onlyB), differences: differences.length,
    mean: differences.reduce((sum, d) => sum + d, 0) / differences.length,
    /** Of the mean; computed on request, since the bootstrap is slow. */
    get interval() { return interval ??= bootstrapMean(differences); },
  };
}

/** Says in words how bootstrapMean() computes its interval. */
export const kMeanInterval = 'paired bootstrap, as in moma compare';

export function pairsText(of: Pairs, a: string, b: string, metric: Metric): string {
  const n = of.worlds.length;
  const test = of.onlyA + of.onlyB === 0 ? 'no world tells them apart' : `exact McNemar ${probability(of.p)}`;
  const outcome = `n = ${integer(n)} worlds: both succeed in ${integer(of.both)}, only ${a} in ${integer(of.onlyA)}, only ${b} in ${integer(of.onlyB)}, neither in ${integer(of.neither)} (${test}).`;
  if (of.differences === 0) return outcome;
  const interval = Number.isFinite(of.interval.low) ? `, 95 % interval ${metric.write(of.interval.low)} to ${withUnit(metric, of.interval.high)} (${kMeanInterval})` : ', no interval of so few';
  return `${outcome} Mean difference of ${metric.name}, ${b} less ${a}, where both have it (n = ${integer(of.differences)}): ${withUnit(metric, of.mean)}${interval}.`;
}
