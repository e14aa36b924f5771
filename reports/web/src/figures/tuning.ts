// A search for gains: what was found and whether it holds on other worlds, how the search went, what matters.

import { axis, gainAxis, gridBox, nice, pathSeries, ruler, smallMultiples, stairs, tip, tipOf, whiskers, type FigureSpec } from '../chart';
import { figure } from '../figure';
import type { Model, TuneSearch } from '../data';
import { h, table } from '../dom';
import { integer, percent, percentRange, plural, probability, significant } from '../format';
import { metric } from '../metrics';
import { difference, isRate, named, verdictOf } from '../search_words';
import { seriesColour } from '../theme';
import { short } from './swept';

function gains(search: TuneSearch): HTMLElement {
  const most = Math.max(1e-9, ...search.variables.map((v) => v.importance ?? 0));
  return table('Gains', ['Gain', 'Searched', 'Start', 'Found', 'Share of the variance'], search.variables.map((v) => [
    short(v.key), `${significant(v.lower)} \u2026 ${significant(v.upper)}${v.scale === 'linear' ? '' : `, ${v.scale}`}`, significant(v.start), h('b', null, significant(v.found)),
    v.importance === null ? '\u2013' : h('span', { class: 'share', style: `--w:${(100 * v.importance) / most}%` }, `${integer(100 * v.importance)}\u00a0%`),
  ]), 'gains');
}

type Comparison = TuneSearch['comparisons'][number];
type Evaluation = TuneSearch['evaluations'][number];

/** A value of a metric of the comparison; rates in percent, their differences in points. */
function written(key: string, v: number | null): string {
  return v === null ? '\u2013' : isRate(key) ? percent(v) : metric(key).write(v);
}

function comparisons(search: TuneSearch): HTMLElement | null {
  if (search.comparisons.length === 0) return null;
  const range = (name: string, low: number | null, high: number | null): string =>
    (low === null || high === null ? '' : isRate(name) ? percentRange(low, high) : `${metric(name).write(low)} to ${metric(name).write(high)}`);
  return h('details', null, h('summary', null, `All ${plural(search.comparisons.length, 'comparison')} in numbers`),
    table('Comparison on held-out worlds', ['Metric', 'Worlds', 'Found gains', 'Compared with', 'Difference', 'Verdict'], search.comparisons.map((c) => [
      named(c.metric), `${c.family}, n = ${integer(c.n)}`, [h('b', null, written(c.metric, c.found)), h('small', null, range(c.metric, c.found_low, c.found_high))],
      [written(c.metric, c.theirs), h('small', null, `${c.other} ${range(c.metric, c.theirs_low, c.theirs_high)}`)],
      [written(c.metric, c.difference), h('small', null, range(c.metric, c.difference_low, c.difference_high))], [c.verdict, c.p === null ? null : h('small', null, `${probability(c.p)}, Holm`)],
    ])));
}

/** One forest plot per metric: the found gains less each other controller, in each family. */
function held(search: TuneSearch, id: string): FigureSpec {
  return {
    id: `heldout${id}`,
    title: 'Found gains less the others, on held-out worlds',
    caption: 'A plot per metric, a row per family of worlds and controller compared with: the paired difference with its 95 % interval. Filled where it is shown to differ.',
    empty: 'Nothing has been judged yet.',
    draw: (p, width) => {
      const all = search.comparisons.filter((c) => c.difference !== null);
      const keys = [...new Set(all.map((c) => c.metric))];
      if (all.length === 0) return null;
      const row = (c: Comparison): string => `${c.family}, ${c.other}`;
      const rows = [...new Set(all.map(row))];
      const left = Math.min(0.3 * width, 14 + 6.6 * Math.max(...rows.map((r) => r.length)));
      const colour = seriesColour(p, 0);
      const scale = (key: string): number => (isRate(key) ? 100 : 1);
      const of = keys.map((key) => all.filter((c) => c.metric === key));
      return {
        note: `n = ${[...new Set(all.map((c) => c.n))].map(integer).join(', ')} worlds. Rates: exact McNemar, Holm\u2019s correction over all; others: paired bootstrap.`,
        columns: ['metric', 'family', 'other', 'n', 'difference', 'low', 'high', 'p', 'verdict'],
        rows: all.map((c) => [c.metric, c.family, c.other, c.n, c.difference, c.difference_low, c.difference_high, c.p, c.verdict]),
        ...smallMultiples(width, keys.map((key) => ({ title: `${named(key)}${isRate(key) ? ' [points]' : metric(key).unit && ` [${metric(key).unit}]`}`, colour: p.ink })),
          (i) => {
            const ends = (key: 'difference_low' | 'difference_high'): number[] => of[i]!.map((c) => scale(c.metric) * (c[key] ?? c.difference ?? 0));
            return axis(p, '', nice(Math.min(0, ...ends('difference_low')), Math.max(0, ...ends('difference_high')), 4));
          },
          {
            type: 'category', inverse: true, data: rows, axisTick: { show: false }, splitLine: { show: false }, axisLine: { show: false },
            axisLabel: { color: p.ink, width: left - 12, overflow: 'truncate' },
          },
          (i) => [
            ruler(p, [0, rows[0] ?? ''], [0, rows[rows.length - 1] ?? '']),
            whiskers(of[i]!.filter((c) => c.difference_low !== null).map((c) => [scale(c.metric) * (c.difference_low ?? 0), scale(c.metric) * (c.difference_high ?? 0), rows.indexOf(row(c))]), colour, { level: true, width: 2 }),
            {
              type: 'scatter', symbolSize: 9, z: 4,
              data: of[i]!.map((c) => ({ value: [scale(c.metric) * (c.difference ?? 0), row(c)], of: c, itemStyle: { color: c.verdict === 'no difference shown' ? p.surface : colour, borderColor: colour, borderWidth: 2 } })),
            },
          ],
          tipOf((c: Comparison) => tip(row(c), [['difference', difference(c)], ['verdict', c.verdict]], colour)),
          { left, narrowest: 280, most: 3, high: 22 * rows.length + 8 }),
      };
    },
  };
}

function history(search: TuneSearch, id: string): FigureSpec {
  return {
    id: `search${id}`,
    title: 'How the search went',
    caption: 'Every candidate in the order in which it was measured, and the best so far. Low is good; candidates that were cut short are hollow.',
    empty: 'No candidate has been measured yet.',
    draw: (p) => {
      const all = search.evaluations.filter((e) => e.phase !== 'sensitivity' && Number.isFinite(e.merit));
      if (all.length === 0) return null;
      let best = Infinity;
      const front = all.flatMap((e): [number, number][] => {
        if (e.cut === 0 && e.valid === 1) best = Math.min(best, e.merit);
        return Number.isFinite(best) ? [[e.evaluation, best]] : [];
      });
      // A few hopeless candidates would squeeze all others.
      const merits = all.map((e) => e.merit).sort((a, b) => a - b);
      const low = merits[0] ?? 0;
      const range = nice(low, merits[Math.floor(0.95 * (merits.length - 1))] ?? low);
      const colour = seriesColour(p, 0);
      return {
        height: 330,
        note: `n = ${plural(all.length, 'candidate')}, ${integer(search.trials ?? 0)} of ${plural(search.budget_trials, 'trial')}${search.trials_saved ? `; cutting hopeless candidates short saved ${integer(search.trials_saved)}` : ''}. Objective: ${search.objective}.`,
        columns: ['evaluation', 'phase', 'worlds', 'cut', 'valid', 'cost', 'merit', ...search.variables.map((v) => v.key)],
        rows: all.map((e) => [e.evaluation, e.phase, e.worlds, e.cut, e.valid, e.cost, e.merit, ...e.candidate]),
        option: {
          grid: gridBox(14, 16, 8), xAxis: axis(p, 'candidate', { splitLine: { show: false } }), yAxis: axis(p, search.unit === '' ? 'objective' : `objective [${search.unit}]`, { ...range, nameGap: 42 }),
          tooltip: tipOf((e: Evaluation) => tip(`candidate ${integer(e.evaluation)}, ${e.phase}`, [['objective', significant(e.merit)], ['worlds', `${integer(e.worlds)}${e.cut ? ', cut short' : ''}`],
            ...search.variables.map((v, i) => [short(v.key), significant(e.candidate[i])] as const)])),
          series: [
            {
              type: 'scatter', clip: true, symbolSize: 6,
              data: all.map((e) => ({ value: [e.evaluation, e.merit], of: e, itemStyle: { color: e.cut ? 'transparent' : colour, borderColor: colour, borderWidth: 1, opacity: e.cut ? 0.45 : 0.6 } })),
            },
            pathSeries('best so far', stairs(front), { colour: seriesColour(p, 1), width: 2 }),
          ],
        },
      };
    },
  };
}

function sensitivity(search: TuneSearch, id: string): FigureSpec {
  return {
    id: `sensitivity${id}`,
    title: 'What a gain matters',
    caption: 'A slice for each gain, the one that explains most first: change of the objective when it alone moves away from what was found (the upright line); bars are one standard error.',
    empty: 'This search measured no sensitivities.',
    draw: (p, width) => {
      const lines = search.variables.map((v, i) => ({
        v, found: v.found, steps: search.sensitivity.flatMap((s) => (s.variable === i && s.value !== null && s.valid === 1 ? [{ ...s, value: s.value }] : [])).sort((a, b) => a.value - b.value),
      })).filter((line) => line.steps.length > 1).sort((a, b) => (b.v.importance ?? -1) - (a.v.importance ?? -1));
      if (lines.length === 0) return null;
      const all = lines.flatMap((line) => line.steps);
      const range = nice(Math.min(0, ...all.map((s) => s.change - s.error)), Math.max(0, ...all.map((s) => s.change + s.error)), 3);
      const axes = lines.map((line) => gainAxis(p, [...line.steps.map((s) => s.value), ...(line.found === null ? [] : [line.found])], 240));
      const colour = seriesColour(p, 0);
      return {
        note: `n = ${plural(lines.length, 'gain')}; bars: one standard error. A flat slice is a gain that need not be tuned.`,
        columns: ['gain', 'found', 'value', 'change', 'error'],
        rows: lines.flatMap((line) => line.steps.map((s) => [line.v.key, line.found, s.value, s.change, s.error])),
        ...smallMultiples(width, lines.map((line) => ({ title: short(line.v.key), colour: p.ink })), (place) => axes[place]?.option ?? {},
          axis(p, search.unit === '' ? 'change' : `change [${search.unit}]`, range), (place) => {
            const { steps, found } = lines[place]!;
            const at = axes[place]!.at;
            // Nothing changes where nothing is moved.
            const path = [...steps.map((s): [number, number] => [at(s.value), s.change]), ...(found === null || steps.some((s) => s.value === found) ? [] : [[at(found), 0] as [number, number]])].sort((a, b) => a[0] - b[0]);
            return [
              ...(found === null ? [] : [ruler(p, [at(found), range.min], [at(found), range.max])]),
              pathSeries('', path, { colour, width: 1.6 }),
              whiskers(steps.map((s) => [at(s.value), s.change - s.error, s.change + s.error]), colour),
              { type: 'scatter', symbolSize: 7, z: 5, itemStyle: { color: colour }, data: steps.map((s) => ({ value: [at(s.value), s.change], of: s })) },
            ];
          }, tipOf((s: (typeof all)[number]) => tip(short(search.variables[s.variable]?.key ?? ''), [['value', significant(s.value)], ['change', `${significant(s.change)} \u00b1 ${significant(s.error, 2)} ${search.unit}`]], colour))),
      };
    },
  };
}

export function tuning(model: Model): Node[] {
  return model.page.tuning.flatMap((search, i) => [
    h('div', { class: 'panel' },
      h('h3', null, `Gains of ${search.controller} in ${search.suite}`), ...verdictOf(search).map((text, k) => h('p', { class: k === 0 ? 'judged' : 'note' }, text)),
      gains(search), comparisons(search),
      ...search.notes.map((note) => h('p', { class: 'note' }, `Note: ${note}.`))),
    ...[held, history, sensitivity].map((of) => figure(of(search, i === 0 ? '' : String(i + 1)))),
  ]);
}
