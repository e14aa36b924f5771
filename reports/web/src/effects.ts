// Main effects of gains in a full factorial on common worlds: analysis of variance over points and worlds, with a
// delete-a-group jackknife over the worlds for the errors.

import { jackknifeErrors, kJackknifeGroups } from './stats';

/**
 * Shares of what the points differ by: for a gain with L values, (SS_gain - (L - 1) s2) / (SS_points - (P - 1) s2), with the
 * sums of squares of the means and s2 the mean square of what points and worlds together leave over, that is the estimate of
 * the variance component by the method of moments (Searle, Casella and McCulloch, Variance Components, 1992, 4). By chance a
 * share may lie a little outside of 0 to 1.
 * Null where, `tested`, the points differ by no more than chance.
 */
function once(levels: readonly (readonly number[])[], values: readonly (readonly number[])[], used: (world: number) => boolean, tested: boolean): number[] | null {
  const worlds = (values[0] ?? []).flatMap((_, w) => (used(w) ? [w] : []));
  const [points, n] = [values.length, worlds.length];
  if (points < 2 || n < 2) return null;
  const mean = (all: readonly number[]): number => all.reduce((sum, v) => sum + v, 0) / all.length;
  const ofPoint = values.map((row) => mean(worlds.map((w) => row[w] ?? 0)));
  const ofWorld = new Map(worlds.map((w) => [w, mean(values.map((row) => row[w] ?? 0))]));
  const grand = mean(ofPoint);
  let left = 0;
  values.forEach((row, i) => { for (const w of worlds) left += ((row[w] ?? 0) - (ofPoint[i] ?? 0) - (ofWorld.get(w) ?? 0) + grand) ** 2; });
  const chance = left / ((points - 1) * (n - 1));
  const total = n * ofPoint.reduce((sum, m) => sum + (m - grand) ** 2, 0) - (points - 1) * chance;
  // About the 98 % quantile of F with as many worlds: it has mean 1 and variance 2 / (P - 1), nearly.
  const chanceAlone = 1 + 2 * Math.sqrt(2 / (points - 1));
  if (tested && !(total + (points - 1) * chance > chanceAlone * (points - 1) * (chance + 1e-12))) return null;
  return (levels[0] ?? []).map((_, gain) => {
    const groups = new Map<number, number[]>();
    levels.forEach((level, i) => { const key = level[gain] ?? NaN; groups.set(key, [...(groups.get(key) ?? []), ofPoint[i] ?? 0]); });
    const squares = [...groups.values()].reduce((sum, group) => sum + n * group.length * (mean(group) - grand) ** 2, 0);
    return (squares - (groups.size - 1) * chance) / total;
  });
}

/**
 * `levels`: of each point its gains' values; `values`: of each point the measure in each world. Null where the points are not
 * all combinations of their gains' values, each once, or differ by no more than chance; `errors` null where worlds are few.
 */
export function effects(levels: readonly (readonly number[])[], values: readonly (readonly number[])[]): { shares: number[]; errors: number[] | null } | null {
  const counts = (levels[0] ?? []).map((_, gain) => new Set(levels.map((level) => level[gain])).size);
  if (levels.length === 0 || counts.reduce((product, count) => product * count, 1) !== levels.length || new Set(levels.map((level) => level.join())).size !== levels.length) return null;
  const shares = once(levels, values, () => true, true);
  if (shares === null) return null;
  const enough = (values[0]?.length ?? 0) >= 2 * kJackknifeGroups;
  return { shares, errors: enough ? jackknifeErrors((group) => once(levels, values, (world) => world % kJackknifeGroups !== group, false)) : null };
}
