// Empirical distribution of the time to goal over all trials: a trial that fails never arrives.

import { axis, legend, legendHeight, tip, type FigureSpec } from '../chart';
import { fixed, integer, percent, percentRange } from '../format';
import { thinned, wilson } from '../stats';
import { dashOf, seriesColour, type Palette } from '../theme';
import { view } from '../view';

export function arrival(): FigureSpec {
  return {
    id: 'arrival',
    title: 'Arrived by a given time',
    caption: 'Share of all trials at the goal by a given time. Failures never arrive, so a curve ends at the success rate; the band is its 95 % interval.',
    empty: 'No trial reached its goal.',
    draw: (p: Palette, width: number) => {
      const { model, series } = view();
      const curves = series.map((s) => ({
        s, n: s.rows.length,
        times: s.rows.map((row) => model.trials.number('time_to_goal_s', row)).filter(Number.isFinite).sort((a, b) => a - b),
      })).filter((c) => c.n > 0);
      const last = Math.max(...curves.map((c) => c.times[c.times.length - 1] ?? 0));
      if (curves.length === 0 || !(last > 0)) return null;
      const limit = Math.max(...series.map((s) => s.info?.time_limit_s ?? 0));
      const end = Math.min(limit > 0 ? limit : last * 1.05, last * 1.15);
      const steps = curves.map(({ times, n }) => {
        const points: [number, number][] = [[0, 0]];
        for (const i of thinned(times.length)) points.push([times[i] ?? 0, (i + 1) / n]);
        points.push([end, times.length / n]);
        return points;
      });
      return {
        height: 360,
        note: curves.map((c) => `${c.s.name}: ${integer(c.times.length)} of n = ${integer(c.n)} arrived`).join('; ') + '. Bands: pointwise 95 % Wilson.',
        columns: ['controller', 'point', 'time_to_goal_s', 'share_arrived', 'share_low', 'share_high', 'n'],
        rows: curves.flatMap(({ s, times, n }) => times.map((t, i) => {
          const w = wilson(i + 1, n);
          return [s.controller, s.point, t, (i + 1) / n, w.low, w.high, n];
        })),
        option: {
          legend: legend(p, curves.map((c) => c.s.name)),
          grid: { left: 8, right: 20, top: legendHeight(curves.map((c) => c.s.name), width), bottom: 26, outerBoundsMode: 'same', outerBoundsContain: 'axisLabel' },
          xAxis: axis(p, 'time [s]', { min: 0, max: Math.ceil(end), nameGap: 26 }),
          yAxis: axis(p, '', { min: 0, max: 1, axisLabel: { color: p.muted, formatter: (v: number) => `${Math.round(100 * v)} %` } }),
          tooltip: {
            trigger: 'axis', axisPointer: { type: 'line', lineStyle: { color: p.faint } },
            formatter: (items: { axisValue: number }[]) => {
              const t = items[0]?.axisValue ?? 0;
              return tip(`by ${fixed(t, 2)} s`, curves.map(({ s, times, n }) => {
                const hits = times.filter((x) => x <= t).length;
                const w = wilson(hits, n);
                return [s.name, `${percent(hits / n)}  (${percentRange(w.low, w.high)})`] as const;
              }));
            },
          },
          series: curves.flatMap(({ s, n, times }, i) => {
            const colour = seriesColour(p, s.mark);
            const bounds = (steps[i] ?? []).map(([t]) => {
              const hits = times.filter((x) => x <= t).length;
              return { t, ...wilson(hits, n) };
            });
            return [
              {
                name: s.name, type: 'line', step: 'end', showSymbol: false, data: steps[i], z: 5,
                lineStyle: { color: colour, width: 2, type: dashOf(s.mark) }, itemStyle: { color: colour },
                emphasis: { disabled: true },
              },
              ...(curves.length > 4 ? [] : [
                { type: 'line', step: 'end', showSymbol: false, stack: `band${i}`, data: bounds.map((b) => [b.t, b.low]), lineStyle: { opacity: 0 }, silent: true, tooltip: { show: false } },
                {
                  type: 'line', step: 'end', showSymbol: false, stack: `band${i}`, data: bounds.map((b) => [b.t, b.high - b.low]),
                  lineStyle: { opacity: 0 }, areaStyle: { color: colour, opacity: p.dark ? 0.16 : 0.11 }, silent: true, tooltip: { show: false },
                },
              ]),
            ];
          }),
        },
      };
    },
  };
}
