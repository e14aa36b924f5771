// Any metric against any other: one dot per trial.

import { axis, kNarrow, legend, legendHeight, nice, plain, smallMultiples, tip, type FigureSpec, type Option } from '../chart';
import { outcomeName } from '../data';
import { choice } from '../dom';
import { fixed, integer, upper } from '../format';
import { axisName, metric, withUnit } from '../metrics';
import { select } from '../select';
import * as state from '../state';
import { extent, spearman, thinned } from '../stats';
import { seriesColour, seriesInk, symbolOf, type Palette } from '../theme';
import { view } from '../view';
import { presentMetrics } from './distribution';

/** More dots than this hide each other. */
const kMostDots = 20000;
/** Dots of more controllers are no longer told apart: each is then drawn in a plot of its own. */
const kTogether = 6;

function correlation(rho: ReturnType<typeof spearman>): string {
  if (rho === null) return 'none, all values being equal';
  return fixed(rho.value, 2) + (rho.interval === null ? ' (no interval of so few)' : ` (95 % interval ${fixed(rho.interval.low, 2)} to ${fixed(rho.interval.high, 2)})`);
}

export function scatter(): FigureSpec {
  state.setDefault('f.sx', 'goal_distance_m');
  state.setDefault('f.sy', 'manip_mean');
  return {
    id: 'scatter',
    title: () => `${upper(metric(state.get('f.sy')).name)} against ${metric(state.get('f.sx')).name}`,
    caption: () => `Each dot is one trial that has both; hollow where it failed. ${view().model.clickPlays()}`,
    empty: 'No trial here has both metrics.',
    controls: (redraw) => (['sx', 'sy'] as const).map((key) =>
      choice(key === 'sx' ? 'Along x' : 'Along y', presentMetrics(), state.get(`f.${key}`), (value) => { state.set({ [`f.${key}`]: value }); redraw(); })),
    draw: (p: Palette, width: number) => {
      const { model, series } = view();
      const t = model.trials;
      const [mx, my] = [metric(state.get('f.sx')), metric(state.get('f.sy'))];
      const groups = series.map((s) => ({
        s, dots: s.rows.map((row) => ({ row, x: t.number(mx.key, row), y: t.number(my.key, row) })).filter((d) => Number.isFinite(d.x) && Number.isFinite(d.y)),
      })).filter((g) => g.dots.length > 0);
      const xs = extent(groups.flatMap((g) => g.dots.map((d) => d.x)));
      const ys = extent(groups.flatMap((g) => g.dots.map((d) => d.y)));
      if (xs === null || ys === null) return null;
      const total = groups.reduce((sum, g) => sum + g.dots.length, 0);
      const names = groups.map((g) => g.s.short);
      const label = { color: p.muted, fontSize: 11, formatter: plain };
      const tooltip = {
        trigger: 'item',
        formatter: ({ data }: { data: { row: number } }) => tip(`${t.text('controller', data.row)}, ${t.text('family', data.row)} world ${integer(t.number('world', data.row))}`, [
          ['outcome', outcomeName(t.outcome(data.row))], [mx.name, withUnit(mx, t.number(mx.key, data.row))], [my.name, withUnit(my, t.number(my.key, data.row))],
        ]),
      };
      const drawn = (place: number): Option => {
        const g = groups[place]!;
        const colour = seriesColour(p, g.s.mark);
        return {
          name: g.s.short, type: 'scatter', symbol: groups.length > kTogether ? 'circle' : symbolOf(g.s.mark), symbolSize: groups.length > kTogether ? 5 : 7, itemStyle: { color: colour }, cursor: 'pointer',
          data: thinned(g.dots.length, Math.ceil((kMostDots * g.dots.length) / Math.max(total, kMostDots))).map((i) => {
            const d = g.dots[i];
            if (d === undefined) return null;
            const filled = t.success(d.row);
            return { value: [d.x, d.y], row: d.row, itemStyle: { color: filled ? colour : 'transparent', borderColor: colour, borderWidth: filled ? 0 : 1.2, opacity: filled ? 0.55 : 0.8 } };
          }),
        };
      };
      return {
        note: groups.map((g) => {
          const rho = spearman(g.dots.map((d) => d.x), g.dots.map((d) => d.y));
          return `${g.s.short}: n = ${integer(g.dots.length)}, rank correlation ${correlation(rho)}`;
        }).join('; ') + (total > kMostDots ? `. ${integer(kMostDots)} dots are drawn.` : '.'),
        columns: ['controller', 'point', 'trial', 'outcome', mx.key, my.key],
        rows: groups.flatMap((g) => g.dots.map((d) => [g.s.controller, g.s.point, t.text('trial', d.row), t.outcome(d.row), d.x, d.y])),
        ...(groups.length <= kTogether ? {
          height: 420,
          option: {
            legend: legend(p, names), tooltip, series: groups.map((_, i) => drawn(i)),
            grid: { left: 8, right: 20, top: legendHeight(names, width), bottom: 8, outerBoundsMode: 'same', outerBoundsContain: 'all' },
            xAxis: axis(p, axisName(mx), { ...nice(...xs, width < kNarrow ? 4 : 8), nameGap: 30, axisLabel: label }),
            yAxis: axis(p, axisName(my), { ...nice(...ys), nameGap: 46, axisLabel: label }),
          },
        } : smallMultiples(width, groups.map((g) => ({ title: g.s.short, colour: seriesInk(p, g.s.mark) })),
          axis(p, axisName(mx), { ...nice(...xs, 3), nameGap: 28, axisLabel: label }), axis(p, '', { ...nice(...ys, 3), axisLabel: label }), (place) => [drawn(place)], tooltip)),
      };
    },
    click: (data) => {
      const row = (data as { row?: number } | undefined)?.row;
      if (row !== undefined) select(view().model.trials.text('trial', row), true);
    },
  };
}
