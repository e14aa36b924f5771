// A search for gains: what was found and whether it holds on other worlds, how the search went, what matters.

import { axis, nice, pathSeries, plain, stairs, tip, type FigureSpec } from '../chart';
import { figure } from '../figure';
import type { Model, TuneSearch } from '../data';
import { h } from '../dom';
import { integer, percent, percentRange, plural, probability, significant } from '../format';
import { metric } from '../metrics';
import { seriesColour, type Palette } from '../theme';

function short(key: string): string {
  return key.replace(/^controllers?\./, '');
}

function gains(search: TuneSearch): HTMLElement {
  const most = Math.max(1e-9, ...search.variables.map((v) => v.importance ?? 0));
  return h('div', { class: 'scroll', tabindex: 0, role: 'region', 'aria-label': 'Gains' }, h('table', { class: 'plain gains' },
    h('thead', null, h('tr', null, ...['Gain', 'Searched', 'Start', 'Found', 'Share of the variance'].map((name) => h('th', { scope: 'col' }, name)))),
    h('tbody', null, ...search.variables.map((v) => h('tr', null,
      h('th', { scope: 'row' }, short(v.key)),
      h('td', null, `${significant(v.lower)} \u2026 ${significant(v.upper)}${v.scale === 'linear' ? '' : `, ${v.scale}`}`),
      h('td', null, significant(v.start)),
      h('td', null, h('b', null, v.found === null ? '\u2013' : significant(v.found))),
      h('td', null, v.importance === null ? '\u2013' : h('span', { class: 'share', style: `--w:${(100 * v.importance) / most}%` }, percent(v.importance, 0))))))));
}

function comparisons(search: TuneSearch): HTMLElement | null {
  if (search.comparisons.length === 0) return null;
  const isRate = (name: string): boolean => name === 'success' || name === 'collision';
  const value = (name: string, v: number | null): string => (v === null ? '\u2013' : isRate(name) ? percent(v) : metric(name).write(v));
  const range = (name: string, low: number | null, high: number | null): string =>
    (low === null || high === null ? '' : isRate(name) ? percentRange(low, high) : `${metric(name).write(low)} to ${metric(name).write(high)}`);
  return h('div', { class: 'scroll', tabindex: 0, role: 'region', 'aria-label': 'Comparison on held-out worlds' }, h('table', { class: 'plain' },
    h('thead', null, h('tr', null, ...['Metric', 'Worlds', 'Found gains', 'Compared with', 'Difference', 'Verdict'].map((name) => h('th', { scope: 'col' }, name)))),
    h('tbody', null, ...search.comparisons.map((c) => h('tr', null,
      h('th', { scope: 'row' }, metric(c.metric).name),
      h('td', null, `${c.family}, n = ${integer(c.n)}`),
      h('td', null, h('b', null, value(c.metric, c.found)), h('small', null, range(c.metric, c.found_low, c.found_high))),
      h('td', null, value(c.metric, c.theirs), h('small', null, `${c.other} ${range(c.metric, c.theirs_low, c.theirs_high)}`)),
      h('td', null, value(c.metric, c.difference), h('small', null, range(c.metric, c.difference_low, c.difference_high))),
      h('td', null, c.verdict, c.p === null ? null : h('small', null, `${probability(c.p)}, Holm`)))))));
}

function history(search: TuneSearch, id: string): FigureSpec {
  return {
    id: `search${id}`,
    title: 'How the search went',
    caption: 'Every candidate in the order in which it was measured, and the best so far. Low is good; candidates that were cut short are hollow.',
    empty: 'No candidate has been measured yet.',
    draw: (p: Palette) => {
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
          grid: { left: 8, right: 16, top: 14, bottom: 8, outerBoundsMode: 'same', outerBoundsContain: 'all' },
          xAxis: axis(p, 'candidate', { nameGap: 26, splitLine: { show: false } }),
          yAxis: axis(p, search.unit === '' ? 'objective' : `objective [${search.unit}]`, { ...range, nameGap: 42, axisLabel: { color: p.muted, formatter: plain } }),
          tooltip: {
            trigger: 'item',
            formatter: ({ dataIndex, seriesIndex }: { dataIndex: number; seriesIndex: number }) => {
              const e = all[dataIndex];
              if (e === undefined || seriesIndex !== 0) return '';
              return tip(`candidate ${integer(e.evaluation)}, ${e.phase}`, [['objective', significant(e.merit)], ['worlds', `${integer(e.worlds)}${e.cut ? ', cut short' : ''}`],
                ...search.variables.map((v, i) => [short(v.key), significant(e.candidate[i])] as const)]);
            },
          },
          series: [
            {
              type: 'scatter', clip: true, symbolSize: 6,
              data: all.map((e) => ({ value: [e.evaluation, e.merit], itemStyle: { color: e.cut ? 'transparent' : colour, borderColor: colour, borderWidth: 1, opacity: e.cut ? 0.45 : 0.6 } })),
            },
            pathSeries('best so far', stairs(front), { colour: seriesColour(p, 1), width: 2 }, { silent: true }),
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
    caption: 'Change of the objective when one gain alone moves away from what was found; errors are in the tooltips.',
    empty: 'This search measured no sensitivities.',
    draw: (p: Palette) => {
      const lines = search.variables.map((v, i) => ({
        v, i, points: search.sensitivity.filter((s) => s.variable === i && s.value !== null && s.valid === 1 && v.found !== null && v.found > 0 && s.value > 0)
          .map((s) => ({ x: (s.value ?? 1) / (v.found ?? 1), s })),
      })).filter((line) => line.points.length > 1);
      if (lines.length === 0) return null;
      return {
        height: 340,
        note: `n = ${integer(lines.length)} gains. A flat curve is a gain that need not be tuned.`,
        columns: ['gain', 'value', 'factor', 'change', 'error'],
        rows: lines.flatMap((line) => line.points.map(({ x, s }) => [line.v.key, s.value, x, s.change, s.error])),
        option: {
          legend: { data: lines.map((line) => short(line.v.key)), top: 0, left: 0, itemWidth: 14, itemHeight: 8, selectedMode: false, textStyle: { color: p.muted, fontSize: 12 } },
          grid: { left: 8, right: 16, top: 40, bottom: 8, outerBoundsMode: 'same', outerBoundsContain: 'all' },
          xAxis: axis(p, 'gain, as a multiple of what was found', { type: 'log', logBase: 2, nameGap: 26, axisLabel: { color: p.muted, formatter: (v: number) => `${significant(v, 2)}\u00d7` } }),
          yAxis: axis(p, search.unit === '' ? 'change' : `change [${search.unit}]`, { nameGap: 42, axisLabel: { color: p.muted, formatter: plain } }),
          tooltip: {
            trigger: 'item',
            formatter: ({ seriesName, dataIndex }: { seriesName: string; dataIndex: number }) => {
              const line = lines.find((l) => short(l.v.key) === seriesName);
              const point = line?.points[dataIndex];
              if (line === undefined || point === undefined) return '';
              return tip(short(line.v.key), [['value', significant(point.s.value)], ['change', `${significant(point.s.change)} \u00b1 ${significant(point.s.error, 2)} ${search.unit}`]], seriesColour(p, line.i));
            },
          },
          series: lines.map((line) => ({
            name: short(line.v.key), type: 'line', data: line.points.map(({ x, s }) => [x, s.change]), symbolSize: 7,
            lineStyle: { color: seriesColour(p, line.i), width: 1.8 }, itemStyle: { color: seriesColour(p, line.i) }, emphasis: { disabled: true },
          })),
        },
      };
    },
  };
}

function figuresOf(search: TuneSearch, index: number): FigureSpec[] {
  const id = index === 0 ? '' : String(index + 1);
  return [history(search, id), sensitivity(search, id)];
}

export function tuningFigures(model: Model): FigureSpec[] {
  return model.page.tuning.flatMap(figuresOf);
}

export function tuning(model: Model): Node[] {
  return model.page.tuning.flatMap((search, i) => {
    const verdict = search.verdict === null
      ? `The search is ${search.status === 'running' ? 'still running, or was killed' : search.status}; nothing has been judged yet.`
      : `On worlds that took no part in the search, the found gains are judged: ${search.verdict}.`;
    return [
      h('div', { class: 'panel' },
        h('h3', null, `Gains of ${search.controller} in ${search.suite}`), h('p', { class: 'judged' }, verdict),
        gains(search), comparisons(search),
        ...search.notes.map((note) => h('p', { class: 'note' }, `Note: ${note}.`))),
      ...figuresOf(search, i).map(figure),
    ];
  });
}

