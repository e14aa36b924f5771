// The price of success: success against a measure that is good when low, and the points that nothing else beats in both.

import { axis, gridBox, marksIn, nice, pathSeries, plain, shareAxis, stairs, tip, tipOf, whiskers, type FigureSpec } from '../chart';
import type { Series, SummaryRow } from '../data';
import { integer, percent, percentRange, plural, sizes } from '../format';
import * as state from '../state';
import { seriesColour } from '../theme';
import { resultOf, view } from '../view';
import { intervalOf, measures, valueOf, type Measure } from './swept';

interface Point { series: Series; row: SummaryRow; cost: number; gain: number }

/** Points that no other is at least as good as in both and better in one; by cost. */
function front(all: readonly Point[]): Point[] {
  let best = -Infinity;
  return [...all].sort((a, b) => a.cost - b.cost || b.gain - a.gain).filter((point) => {
    const leads = point.gain > best;
    if (leads) best = point.gain;
    return leads;
  });
}

export function pareto(): FigureSpec {
  // Stores of before lack the values of newer columns.
  const known = (m: Measure): boolean => view().all.some((series) => { const row = resultOf(series); return row !== undefined && !Number.isNaN(valueOf(row, m)); });
  const costs = (): Measure[] => measures().filter((m) => m.lowIsGood && known(m));
  const cost = (): Measure => costs().find(({ key }) => key === state.get('f.cost')) ?? costs().at(-1) ?? measures()[0]!;
  return {
    id: 'pareto',
    title: () => `Success against ${cost().name}`,
    caption: 'A dot per point with its 95 % intervals of rates. Along the line lie the points that no other beats in both.',
    empty: 'Two points or more are needed.',
    choices: [{ key: 'f.cost', label: 'Cost', options: () => costs().map((m) => [m.key, m.name] as const), value: () => cost().key }],
    draw: (p, width) => {
      const of = cost();
      const points = view().all.flatMap((series): Point[] => {
        const row = resultOf(series);
        const value = row === undefined ? NaN : valueOf(row, of);
        return row === undefined || Number.isNaN(value) ? [] : [{ series, row, cost: value, gain: row.success_rate }];
      });
      if (points.length < 2) return null;
      const best = front(points);
      const spans = points.flatMap((q) => { const interval = intervalOf(q.row, of); return interval === null ? [] : [[...interval, q.gain]]; });
      const all = points.map((q) => q.cost);
      const range = spans.length > 0 ? nice(0, Math.max(...spans.map(([, high = 0]) => high)), marksIn(width)) : nice(Math.min(...all), Math.max(...all), marksIn(width));
      const colour = seriesColour(p, 0);
      // Beside a dot on the side where no other lies, at about the scale of the plot.
      const across = (value: number): number => (value / (range.max - range.min)) * (width - 90);
      const side = (of_: Point): string => {
        const covers = (to: number): boolean => points.some((q) => {
          const [right, up] = [across(q.cost - of_.cost), (q.gain - of_.gain) * 330];
          return to * right > 3 && to * right < 84 && Math.abs(up) < 12;
        });
        return covers(1) && !covers(-1) && across(of_.cost - range.min) > 12 + 6.2 * of_.series.short.length ? 'left' : covers(1) ? 'top' : 'right';
      };
      return {
        height: 400,
        note: `n = ${sizes(points.map((q) => q.row.n))} trials a point; ${plural(best.length, 'point')} of ${integer(points.length)} on the front, by their rates alone: within their intervals others may belong to it. 95 % Wilson.`,
        columns: ['controller', 'point', of.key, 'success_rate', 'success_low', 'success_high', 'n', 'on_front'],
        rows: points.map((q) => [q.series.controller, q.series.point, q.cost, q.gain, q.row.success_low, q.row.success_high, q.row.n, best.includes(q) ? 1 : 0]),
        option: {
          grid: gridBox(12, 24, 8), xAxis: axis(p, of.name, { ...range }, (v) => (spans.length > 0 ? `${plain(100 * v)} %` : plain(v))), yAxis: shareAxis(p, 0.2, { name: 'success rate', nameGap: 44 }),
          tooltip: tipOf((q: Point) => tip(q.series.name, [['success', `${percent(q.gain)} (${percentRange(q.row.success_low, q.row.success_high)})`], [of.name, of.write(q.cost)], ['n', integer(q.row.n)]], colour)),
          series: [
            pathSeries('front', stairs(best.map((b) => [b.cost, b.gain] as const)), { colour: p.faint, width: 1.5, dash: [4, 3] }, { silent: true, tooltip: { show: false }, z: 1 }),
            whiskers(points.map((q) => [q.cost, q.row.success_low, q.row.success_high]), p.faint, { width: 1, z: 2 }),
            whiskers(spans, p.faint, { level: true, width: 1, z: 2 }),
            {
              type: 'scatter', symbolSize: 9, z: 4, labelLayout: { hideOverlap: true, moveOverlap: 'shiftY' },
              data: points.map((q) => ({
                value: [q.cost, q.gain], of: q, itemStyle: { color: best.includes(q) ? colour : p.surface, borderColor: colour, borderWidth: 1.5 },
                label: { show: best.includes(q) && best.length <= 8, position: side(q), distance: 6, formatter: q.series.short, textBorderColor: p.surface, textBorderWidth: 3, color: p.ink, fontSize: 11, overflow: 'truncate', width: 160 },
              })),
            },
          ],
        },
      };
    },
  };
}
