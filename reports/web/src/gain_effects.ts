// Share that each gain explains by itself, with its error: of a full factorial on common worlds by analysis of variance, of a
// search by the decomposition of eval/search/sensitivity.h over the evaluations in the page; errors by a delete-a-group jackknife.

import type { TuneSearch } from './data';
import { jackknifeErrors, kJackknifeGroups, ranks } from './stats';

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

type Variable = Pick<TuneSearch['variables'][number], 'lower' | 'upper' | 'scale'>;
type Evaluation = Pick<TuneSearch['evaluations'][number], 'phase' | 'valid' | 'merit' | 'candidate'>;

function unit(v: Variable, value: number): number {
  const of = (x: number): number => (v.scale === 'log' ? Math.log(x) : x);
  const span = of(v.upper) - of(v.lower);
  return span > 0 ? (of(value) - of(v.lower)) / span : 0.5;
}

/** Solves the symmetric system A x = b by elimination; what A says nothing about is 0. */
function solve(A: number[][], b: number[]): number[] {
  const n = b.length;
  const M = A.map((row, i) => [...row, b[i] ?? 0]);
  const least = 1e-12 * Math.max(...A.map((row, i) => Math.abs(row[i] ?? 0)));
  const pivot = new Array<boolean>(n).fill(false);
  for (let c = 0; c < n; ++c) {
    const row = M[c];
    if (row === undefined || Math.abs(row[c] ?? 0) <= least) continue;
    pivot[c] = true;
    for (let r = 0; r < n; ++r) {
      const other = M[r];
      if (r === c || other === undefined) continue;
      const factor = (other[c] ?? 0) / (row[c] ?? 1);
      for (let k = c; k <= n; ++k) other[k] = (other[k] ?? 0) - factor * (row[k] ?? 0);
    }
  }
  return M.map((row, i) => (pivot[i] === true ? (row[n] ?? 0) / (row[i] ?? 1) : 0));
}

/** Share of the variance of the ranks of merit per gain, less chance, at least 0; null where there are too few. */
export function shares(variables: readonly Variable[], used: readonly Evaluation[]): number[] | null {
  const coefficients = 1 + 2 * variables.length;
  if (used.length < 3 * coefficients) return null;
  const rank = [...ranks(used.map((e) => e.merit))];
  const mean = rank.reduce((sum, r) => sum + r, 0) / rank.length;
  const y = rank.map((r) => r - mean);
  const total = y.reduce((sum, v) => sum + v * v, 0);
  if (total <= 0) return null;
  const terms = used.map((e) => [1, ...variables.flatMap((v, i) => { const d = unit(v, e.candidate[i] ?? 0) - 0.5; return [d, d * d]; })]);
  const gram = Array.from({ length: coefficients }, (_, a) => Array.from({ length: coefficients }, (__, b) => terms.reduce((sum, t) => sum + (t[a] ?? 0) * (t[b] ?? 0), 0)));
  const fit = solve(gram, Array.from({ length: coefficients }, (_, a) => terms.reduce((sum, t, r) => sum + (t[a] ?? 0) * (y[r] ?? 0), 0)));
  const residual = terms.reduce((sum, t, r) => sum + ((y[r] ?? 0) - t.reduce((s, v, k) => s + v * (fit[k] ?? 0), 0)) ** 2, 0);
  const chance = (2 * residual) / (used.length - coefficients);
  return variables.map((_, i) => {
    const part = terms.reduce((sum, t, r) => sum + ((t[1 + 2 * i] ?? 0) * (fit[1 + 2 * i] ?? 0) + (t[2 + 2 * i] ?? 0) * (fit[2 + 2 * i] ?? 0)) * (y[r] ?? 0), 0);
    return Math.max(0, (part - chance) / total);
  });
}

/** The evaluations that the search's own figure is of: the global phase, or all of the search where those are few. */
function evaluationsOf(search: Pick<TuneSearch, 'variables' | 'evaluations'>): Evaluation[] {
  const valid = search.evaluations.filter((e) => e.valid === 1 && Number.isFinite(e.merit));
  const global = valid.filter((e) => e.phase === 'global');
  return global.length >= 3 * (1 + 2 * search.variables.length) ? global : valid.filter((e) => ['start', 'global', 'local'].includes(e.phase));
}

/** Standard errors of the shares: every twentieth evaluation is left out in turn. Null where too few are left. */
export function shareErrors(search: Pick<TuneSearch, 'variables' | 'evaluations'>): number[] | null {
  const used = evaluationsOf(search);
  return jackknifeErrors((group) => shares(search.variables, used.filter((_, i) => i % kJackknifeGroups !== group)));
}
