// Empirical distribution of the time to goal over all trials: a trial that fails never arrives.

import { axis, bandSeries, curveNames, endLabels, nice, pathSeries, smallMultiples, stairs, tip, type FigureSpec, type Option } from '../chart';
import { fixed, integer, percent, percentRange } from '../format';
import { thinned, wilson } from '../stats';
import { dashOf, seriesColour, seriesInk, type Palette } from '../theme';
import { view } from '../view';

/** Curves with their names at their ends; more are drawn each in a plot of its own, the others faint behind it. */
const kTogether = 6;
/** Bands of more than this hide each other. */
const kBands = 4;

export function arrival(): FigureSpec {
  return {
    id: 'arrival',
    title: 'Arrived by a given time',
    caption: 'Share of all trials at the goal by a given time. Failures never arrive, so a curve ends at the success rate.',
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
      const end = nice(0, Math.min(limit > 0 ? limit : last * 1.05, last * 1.15)).max;
      const drawn = curves.map(({ s, times, n }) => {
        const at = (value: (hits: number) => number): [number, number][] => [[0, value(0)], ...thinned(times.length).map((i) => [times[i] ?? 0, value(i + 1)] as [number, number]), [end, value(times.length)]];
        return {
          s, colour: seriesColour(p, s.mark), share: stairs(at((hits) => hits / n)),
          low: stairs(at((hits) => wilson(hits, n).low)), high: stairs(at((hits) => wilson(hits, n).high)), last: times.length / n,
        };
      });
      const arrived = (c: (typeof curves)[number], t: number): number => {   // times are sorted
        let [low, high] = [0, c.times.length];
        while (low < high) {
          const middle = (low + high) >> 1;
          if ((c.times[middle] ?? Infinity) <= t) low = middle + 1;
          else high = middle;
        }
        return low;
      };
      const yAxis = axis(p, '', { min: 0, max: 1, interval: 0.25, axisLabel: { color: p.muted, formatter: (v: number) => `${Math.round(100 * v)} %` } });
      const xAxis = axis(p, 'time [s]', { min: 0, max: end, nameGap: 26 });
      const path = (d: (typeof drawn)[number], style: Option = {}): Option =>
        pathSeries(d.s.short, d.share, { colour: d.colour, width: 2, dash: dashOf(d.s.mark), ...style }, { silent: true, z: 5 });
      const bands = drawn.length <= kBands || drawn.length > kTogether;
      const common = {
        note: curves.map((c) => `${c.s.short}: ${integer(c.times.length)} of n = ${integer(c.n)} arrived`).join('; ') + (bands ? '. Bands: pointwise 95 % Wilson.' : '. The data have the 95 % Wilson intervals.'),
        columns: ['controller', 'point', 'time_to_goal_s', 'share_arrived', 'share_low', 'share_high', 'n'],
        rows: curves.flatMap(({ s, times, n }) => times.map((t, i) => {
          const w = wilson(i + 1, n);
          return [s.controller, s.point, t, (i + 1) / n, w.low, w.high, n];
        })),
      };
      if (drawn.length > kTogether) {
        return {
          ...common,
          ...smallMultiples(width, drawn.map((d) => ({ title: d.s.short, colour: seriesInk(p, d.s.mark) })), xAxis, yAxis, (place) => [
            ...drawn.filter((_, i) => i !== place).map((d) => pathSeries('', d.share, { colour: p.rule, width: 1 }, { silent: true, z: 2 })),
            ...drawn.filter((_, i) => i === place).flatMap((d) => [bandSeries(d.low, d.high, d.colour, 0.14), pathSeries('', d.share, { colour: d.colour, width: 2 }, { silent: true, z: 5 })]),
          ]),
        };
      }
      // Where the pointer is: a line through all times, never seen.
      const ticks = Array.from({ length: 241 }, (_, i) => [(end * i) / 240, 0]);
      const named = curveNames(p, drawn.map((d) => d.s.short), width);
      return {
        height: 360 + named.above, ...common,
        option: {
          grid: named.grid, ...named.option,
          xAxis, yAxis,
          tooltip: {
            trigger: 'axis', axisPointer: { type: 'line', lineStyle: { color: p.faint } },
            formatter: (items: { axisValue: number }[]) => {
              const t = items[0]?.axisValue ?? 0;
              return tip(`by ${fixed(t, 2)} s`, curves.map((c) => {
                const hits = arrived(c, t);
                const w = wilson(hits, c.n);
                return [c.s.short, `${percent(hits / c.n)}  (${percentRange(w.low, w.high)})`] as const;
              }));
            },
          },
          series: [
            { type: 'line', data: ticks, showSymbol: false, lineStyle: { opacity: 0 }, itemStyle: { opacity: 0 }, silent: true, emphasis: { disabled: true } },
            ...drawn.flatMap((d) => [...(bands ? [bandSeries(d.low, d.high, d.colour, p.dark ? 0.16 : 0.11)] : []), path(d)]),
            ...endLabels(drawn.map((d) => ({ name: d.s.short, x: end, y: d.last, colour: seriesInk(p, d.s.mark) })), named.room),
          ],
        },
      };
    },
  };
}
