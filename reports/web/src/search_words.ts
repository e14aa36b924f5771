// Result of a search for gains in words.

import type { TuneSearch } from './data';
import { fixed, plural, probability, upper } from './format';
import { metric } from './metrics';

type Comparison = TuneSearch['comparisons'][number];

export function isRate(name: string): boolean {
  return name === 'success' || name === 'collision';
}

export function named(key: string): string {
  return key === 'objective' ? 'objective' : isRate(key) ? `${key} rate` : metric(key).name;
}

/** "success rate +12.0 points (7.0 to 17.0), p < 0.001" */
export function difference(c: Comparison): string {
  const write = (v: number | null): string => (v === null ? '\u2013' : isRate(c.metric) ? fixed(100 * v, 1) : metric(c.metric).write(v));
  const value = `${(c.difference ?? 0) > 0 ? '+' : ''}${write(c.difference)}${isRate(c.metric) ? ' points' : metric(c.metric).unit && ` ${metric(c.metric).unit}`}`;
  const interval = c.difference_low === null || c.difference_high === null ? '' : ` (${write(c.difference_low)} to ${write(c.difference_high)})`;
  return `${named(c.metric)} ${value}${interval}${c.p === null ? '' : `, ${probability(c.p)}`}`;
}

const kCriterion: Record<string, string> = {
  better: 'success or the objective is shown to be better, and neither success nor collisions are shown to be worse',
  worse: 'success or collisions are shown to be worse',
  'no difference shown': 'neither success nor the objective is shown to be better, nor success or collisions to be worse',
};

export function verdictOf(search: TuneSearch): string[] {
  if (search.verdict === null) {
    const still = search.writer === 'at work' ? 'still running' : search.writer === 'gone' ? 'was killed; the same command goes on' : 'still running, or was killed';
    return [`The search for gains of ${search.controller} is ${search.status === 'running' ? still : search.status}: nothing has been judged yet.`.replace('is was', 'was')];
  }
  const families = new Set(search.comparisons.map((c) => c.family));
  const whole = families.has('all') ? 'all' : [...families][0];
  const others = [...new Set(search.comparisons.map((c) => c.other))];
  const preset = others.includes(search.controller) ? search.controller : others[0];
  const told = search.comparisons.filter((c) => c.family === whole && c.other === preset);
  const first = (c: Comparison): boolean => isRate(c.metric) || c.metric === 'objective';
  const shown = [...told].sort((a, b) => Number(first(b)) - Number(first(a))).filter((c) => c.difference !== null).slice(0, 4);
  return [
    `Gains found for ${search.controller}, on ${told[0] === undefined ? 'worlds' : plural(told[0].n, 'world')} that took no part in the search: ${search.verdict}.`,
    ...(shown.length === 0 ? [] : [`Against ${preset ?? ''}: ${shown.map(difference).join('; ')}.`]),
    ...(kCriterion[search.verdict] === undefined ? [] : [`\u201c${upper(search.verdict)}\u201d: ${kCriterion[search.verdict]} (exact McNemar with Holm\u2019s correction, paired bootstrap). The score of the search takes no part.`]),
  ];
}
