// What more success costs: success against command change or collisions, and the points that nothing else beats in both.

import { axis, kNarrow, nice, pathSeries, plain, stairs, tip, whisker, type FigureSpec } from '../chart';
import { inSlice, type Series, type SummaryRow } from '../data';
import { choice } from '../dom';
import { integer, percent, percentRange, plural, significant, sizes } from '../format';
import * as state from '../state';
import { seriesColour, type Palette } from '../theme';
import { view } from '../view';

const kCosts = [['command_change_mean', 'command change, mean'], ['collision_rate', 'collision rate']] as const;

interface Point { series: Series; row: SummaryRow; cost: number }

/** Points that no other is at least as good as in both and better in one; by cost. */
export function front<T extends { cost: number; gain: number }>(all: readonly T[]): T[] {
  const out: T[] = [];
  let best = -Infinity;
  for (const point of [...all].sort((a, b) => a.cost - b.cost || b.gain - a.gain)) {
    if (point.gain <= best) continue;
    best = point.gain;
    out.push(point);
  }
  return out;
}

export function pareto(): FigureSpec {
  state.setDefault('f.cost', 'command_change_mean');
  const cost = (): (typeof kCosts)[number] => kCosts.find(([key]) => key === state.get('f.cost')) ?? kCosts[0];
  return {
    id: 'pareto',
    title: () => `Success against ${cost()[1]}`,
    caption: 'A dot per point with its 95 % intervals of rates. Along the line lie the points that no other beats in both.',
    empty: 'Two points or more are needed.',
    controls: (redraw) => [choice('Cost', kCosts, cost()[0], (value) => { state.set({ 'f.cost': value }); redraw(); })],
    draw: (p: Palette, width: number) => {
      const { model, slice, family, all } = view();
      const [key, name] = cost();
      const rows = (family === '' ? model.page.overall : model.page.summary.filter((s) => s.family === family)).filter((r) => inSlice(r, slice));
      const points = all.flatMap((series): Point[] => {
        const row = rows.find((r) => r.controller === series.controller && r.point === series.point);
        const value = row?.[key];
        return row === undefined || typeof value !== 'number' ? [] : [{ series, row, cost: value }];
      });
      if (points.length < 2) return null;
      const isRate = key === 'collision_rate';
      const best = front(points.map((point) => ({ point, cost: point.cost, gain: point.row.success_rate })));
      const chosen = new Set(best.map((b) => b.point));
      const costs = points.map((q) => q.cost);
      const range = isRate ? nice(0, Math.max(...points.map((q) => q.row.collision_high)), width < kNarrow ? 4 : 7) : nice(Math.min(...costs), Math.max(...costs), width < kNarrow ? 4 : 7);
      const colour = seriesColour(p, 0);
      // Beside a dot on the side where no other lies, at about the scale of the plot.
      const across = (cost: number): number => (cost / (range.max - range.min)) * (width - 90);
      const side = ({ series, cost: x, row: { success_rate: y } }: Point): string => {
        const covers = (to: number): boolean => points.some((q) => {
          const [right, up] = [across(q.cost - x), (q.row.success_rate - y) * 330];
          return to * right > 3 && to * right < 84 && Math.abs(up) < 12;
        });
        return covers(1) && !covers(-1) && across(x - range.min) > 12 + 6.2 * series.short.length ? 'left' : covers(1) ? 'top' : 'right';
      };
      return {
        height: 400,
        note: `n = ${sizes(points.map((q) => q.row.n))} trials a point; ${plural(best.length, 'point')} of ${integer(points.length)} on the front, by their rates alone: within their intervals others may belong to it. 95 % Wilson.`,
        columns: ['controller', 'point', key, 'success_rate', 'success_low', 'success_high', 'n', 'on_front'],
        rows: points.map((q) => [q.series.controller, q.series.point, q.cost, q.row.success_rate, q.row.success_low, q.row.success_high, q.row.n, chosen.has(q) ? 1 : 0]),
        option: {
          grid: { left: 8, right: 24, top: 12, bottom: 8, outerBoundsMode: 'same', outerBoundsContain: 'all' },
          xAxis: axis(p, name, { ...range, nameGap: 28, axisLabel: { color: p.muted, fontSize: 11, hideOverlap: true, formatter: isRate ? (v: number) => `${plain(100 * v)} %` : plain } }),
          yAxis: axis(p, 'success rate', { min: 0, max: 1, nameGap: 44, axisLabel: { color: p.muted, fontSize: 11, formatter: (v: number) => `${Math.round(100 * v)} %` } }),
          tooltip: {
            trigger: 'item',
            formatter: ({ data }: { data: { place?: number } }) => {
              const q = points[data.place ?? -1];
              return q === undefined ? '' : tip(q.series.name, [['success', `${percent(q.row.success_rate)} (${percentRange(q.row.success_low, q.row.success_high)})`], [name, isRate ? percent(q.cost) : significant(q.cost)], ['n', integer(q.row.n)]], colour);
            },
          },
          series: [
            pathSeries('front', stairs(best.map((b) => [b.cost, b.gain] as const)), { colour: p.faint, width: 1.5, dash: [4, 3] }, { silent: true, tooltip: { show: false }, z: 1 }),
            { type: 'custom', silent: true, tooltip: { show: false }, data: points.map((q) => [q.cost, q.row.success_low, q.row.success_high]), encode: { x: 0, y: [1, 2] }, renderItem: whisker(p.faint, false, 1), z: 2 },
            ...(isRate ? [{ type: 'custom', silent: true, tooltip: { show: false }, data: points.map((q) => [q.row.collision_low, q.row.collision_high, q.row.success_rate]), encode: { x: [0, 1], y: 2 }, renderItem: whisker(p.faint, true, 1), z: 2 }] : []),
            {
              type: 'scatter', symbolSize: 9, z: 4,
              data: points.map((q, place) => ({
                value: [q.cost, q.row.success_rate], place, itemStyle: { color: chosen.has(q) ? colour : p.surface, borderColor: colour, borderWidth: 1.5 },
                label: { show: chosen.has(q) && best.length <= 8, position: side(q), distance: 6, formatter: q.series.short, textBorderColor: p.surface, textBorderWidth: 3, color: p.ink, fontSize: 11, overflow: 'truncate', width: 160 },
              })),
              labelLayout: { hideOverlap: true, moveOverlap: 'shiftY' },
            },
          ],
        },
      };
    },
  };
}
