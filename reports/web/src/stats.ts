// The statistics of the page. Rates carry 95 % Wilson intervals, pairs an exact McNemar test.

/** Two-sided 95 % point of the normal distribution, as in the store's views. */
const kZ = 1.959963984540054;

export interface Interval { low: number; high: number }

/** Wilson score interval of `hits` of `n` (JASA 22, 1927). NaN without trials. */
export function wilson(hits: number, n: number): Interval {
  if (n === 0) return { low: NaN, high: NaN };
  const p = hits / n;
  const z2 = kZ * kZ;
  const centre = (p + z2 / (2 * n)) / (1 + z2 / n);
  const half = (kZ * Math.sqrt((p * (1 - p)) / n + z2 / (4 * n * n))) / (1 + z2 / n);
  return { low: Math.max(0, centre - half), high: Math.min(1, centre + half) };
}

/** Exact two-sided McNemar test: b and c are the discordant pairs. */
export function mcnemar(b: number, c: number): number {
  const n = b + c;
  if (n === 0) return 1;
  let sum = 0;
  let logChoose = 0;
  for (let k = 0; k <= Math.min(b, c); ++k) {
    if (k > 0) logChoose += Math.log((n - k + 1) / k);
    sum += Math.exp(logChoose - n * Math.LN2);
  }
  return Math.min(1, 2 * sum);
}

/** Difference B - A of two paired rates: `onlyA` and `onlyB` of n pairs are hits of one alone. */
export interface PairedRate extends Interval { onlyA: number; onlyB: number; n: number; value: number; p: number }

/** With the adjusted Wald interval of Bonett and Price (J. Educ. Behav. Stat. 37, 2012) and the exact McNemar test. */
export function pairedRate(onlyA: number, onlyB: number, n: number): PairedRate {
  const [a, b] = [(onlyA + 1) / (n + 2), (onlyB + 1) / (n + 2)];
  const half = kZ * Math.sqrt((a + b - (b - a) ** 2) / (n + 2));
  return { onlyA, onlyB, n, value: (onlyB - onlyA) / n, low: Math.max(-1, b - a - half), high: Math.min(1, b - a + half), p: mcnemar(onlyA, onlyB) };
}

/** Holm's step-down correction, in the order given. */
export function holm(p: readonly number[]): number[] {
  const order = p.map((_, i) => i).sort((a, b) => (p[a] ?? 0) - (p[b] ?? 0));
  const out = new Array<number>(p.length).fill(1);
  let running = 0;
  order.forEach((index, rank) => {
    running = Math.max(running, Math.min(1, (p[index] ?? 1) * (p.length - rank)));
    out[index] = running;
  });
  return out;
}

/** Least and greatest of the finite values, which may be too many for Math.min(...values); null where there is none. */
export function extent(values: Iterable<number>): [number, number] | null {
  let [low, high] = [Infinity, -Infinity];
  for (const value of values) {
    if (!Number.isFinite(value)) continue;
    if (value < low) low = value;
    if (value > high) high = value;
  }
  return low <= high ? [low, high] : null;
}

/** Indices 0 ... n - 1, at most about `most` of them, evenly spread, with the first and the last. */
export function thinned(n: number, most = 1500): number[] {
  if (n <= most) return Array.from({ length: n }, (_, i) => i);
  return Array.from({ length: most }, (_, i) => Math.round((i * (n - 1)) / (most - 1)));
}

/** Linear interpolation between order statistics (R's type 7); `sorted` ascending, not empty. */
export function quantile(sorted: ArrayLike<number>, probability: number): number {
  const position = (sorted.length - 1) * probability;
  const below = Math.floor(position);
  const low = sorted[below] ?? NaN;
  const high = sorted[Math.min(below + 1, sorted.length - 1)] ?? NaN;
  return low + (high - low) * (position - below);
}

/** Ranks from 1, ties shared. */
function ranks(values: readonly number[]): Float64Array {
  const order = values.map((_, i) => i).sort((a, b) => (values[a] ?? 0) - (values[b] ?? 0));
  const out = new Float64Array(values.length);
  for (let i = 0; i < order.length;) {
    let j = i;
    while (j + 1 < order.length && values[order[j + 1] ?? 0] === values[order[i] ?? 0]) ++j;
    for (let k = i; k <= j; ++k) out[order[k] ?? 0] = (i + j) / 2 + 1;
    i = j + 1;
  }
  return out;
}

/** Fisher's transformation is not near normal below this. */
const kFewestRanks = 10;

/**
 * Spearman's rank correlation with a 95 % interval by Fisher's transformation, whose variance is
 * (1 + rho^2 / 2) / (n - 3) (Bonett and Wright, Psychometrika 65, 2000). null where undefined; no interval of few pairs,
 * nor at -1 and 1, where the transformation has none.
 */
export function spearman(x: readonly number[], y: readonly number[]): { value: number; interval: Interval | null } | null {
  const n = x.length;
  if (n < 4) return null;
  const [a, b] = [ranks(x), ranks(y)];
  const mean = (n + 1) / 2;
  let [xy, xx, yy] = [0, 0, 0];
  for (let i = 0; i < n; ++i) {
    const [u, v] = [(a[i] ?? 0) - mean, (b[i] ?? 0) - mean];
    xy += u * v;
    xx += u * u;
    yy += v * v;
  }
  if (xx === 0 || yy === 0) return null;
  const value = Math.min(1, Math.max(-1, xy / Math.sqrt(xx * yy)));
  if (n < kFewestRanks || 1 - Math.abs(value) < 1e-12) return { value, interval: null };
  const half = kZ * Math.sqrt((1 + value * value / 2) / (n - 3));
  return { value, interval: { low: Math.tanh(Math.atanh(value) - half), high: Math.tanh(Math.atanh(value) + half) } };
}

export type Spread = NonNullable<ReturnType<typeof spread>>;

/** Summary of finite values; null where there is none. */
export function spread(values: readonly number[]) {
  const sorted = Float64Array.from(values).sort();
  if (sorted.length === 0) return null;
  let sum = 0;
  for (const value of sorted) sum += value;
  const [min, p5, q1, median, q3, p95, max] = [0, 0.05, 0.25, 0.5, 0.75, 0.95, 1].map((share) => quantile(sorted, share)) as [number, number, number, number, number, number, number];
  return { n: sorted.length, min, p5, q1, median, q3, p95, max, mean: sum / sorted.length };
}

/** Gaussian kernel density on `points` positions over [low, high], Silverman's bandwidth; scaled to peak 1. */
export function density(values: readonly number[], low: number, high: number, points: number): [number, number][] {
  const s = spread(values);
  if (s === null || !(high > low)) return [];
  let variance = 0;
  for (const value of values) variance += (value - s.mean) ** 2;
  const deviation = Math.sqrt(variance / Math.max(1, s.n - 1));
  const scale = Math.min(deviation, (s.q3 - s.q1) / 1.34) || deviation;
  const bandwidth = Math.max(0.9 * scale * s.n ** -0.2, (high - low) / 200);
  const out: [number, number][] = [];
  let peak = 0;
  for (let i = 0; i < points; ++i) {
    const x = low + ((high - low) * i) / (points - 1);
    let sum = 0;
    for (const value of values) {
      const u = (x - value) / bandwidth;
      if (u * u < 36) sum += Math.exp(-0.5 * u * u);
    }
    peak = Math.max(peak, sum);
    out.push([x, sum]);
  }
  return out.map(([x, y]) => [x, peak > 0 ? y / peak : 0]);
}

/** All of fewer differences lie on one side of their median more than once in twenty times (2 * 0.5^n): no 95 % interval. */
const kFewestDifferences = 6;

/** More differences than this are not resampled: the bootstrap approaches mean -+ z standard errors. */
const kResampled = 300;

/** High 32 bits of a product of 32 bits each; Math.imul has the low ones. */
function high(a: number, b: number): number {
  return Math.floor(((a >>> 16) * b + Math.floor(((a & 0xffff) * b) / 65536)) / 65536);   // 48 bits: exact
}

const kRounds = 9999;

/** Draws for four differences in each round: the same whatever the differences are, so that each block is drawn once. */
const blocks: Uint32Array[] = [];

/** Philox4x32-10 (Salmon et al., SC 2011) with the key (1, 0): four words from each counter (block, round, 0, 0). */
function wordsOf(block: number): Uint32Array {
  const known = blocks[block];
  if (known !== undefined) return known;
  const out = new Uint32Array(4 * kRounds);
  for (let at = 0; at < kRounds; ++at) {
    let [x, y, z, w] = [block, at, 0, 0];
    let [k, l] = [1, 0];
    for (let round = 0; round < 10; ++round) {
      const next = high(0xcd9e8d57, z) ^ y ^ k;
      const last = high(0xd2511f53, x) ^ w ^ l;
      y = Math.imul(0xcd9e8d57, z) >>> 0;
      w = Math.imul(0xd2511f53, x) >>> 0;
      x = next >>> 0;
      z = last >>> 0;
      k = (k + 0x9e3779b9) >>> 0;
      l = (l + 0xbb67ae85) >>> 0;
    }
    out.set([x, y, z, w], 4 * at);
  }
  return blocks[block] = out;
}

/**
 * 95 % interval of the mean of paired differences, digit for digit that of `moma compare` (eval/stats/intervals.h): the
 * percentile bootstrap, whose draws depend on nothing but their place. NaN of fewer than six.
 */
export function bootstrapMean(differences: readonly number[]): Interval {
  const n = differences.length;
  if (n < kFewestDifferences) return { low: NaN, high: NaN };
  if (n > kResampled) {
    const mean = differences.reduce((sum, d) => sum + d, 0) / n;
    const half = kZ * Math.sqrt(differences.reduce((sum, d) => sum + (d - mean) ** 2, 0) / (n - 1) / n);
    return { low: mean - half, high: mean + half };
  }
  const means = new Float64Array(kRounds);
  const values = Float64Array.from(differences);
  for (let i = 0; i < n; i += 4) {
    const words = wordsOf(i / 4);
    for (let round = 0; round < kRounds; ++round) {
      let sum = means[round] ?? NaN;
      for (let k = 0; k < Math.min(4, n - i); ++k) sum += values[Math.floor(((words[4 * round + k] ?? 0) * n) / 4294967296)] ?? NaN;
      means[round] = i + 4 < n ? sum : sum / n;
    }
  }
  means.sort();
  return { low: quantile(means, 0.025), high: quantile(means, 0.975) };
}
