// Empirical distribution of the time to goal over all trials: a trial that fails never arrives.

import { axis, bandSeries, nice, pathSeries, plots, shareAxis, stairs, tip, type FigureSpec, type Option } from '../chart';
import { fixed, integer, percent, percentRange } from '../format';
import { thinned, wilson } from '../stats';
import { dashOf, seriesColour } from '../theme';
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
    draw: (p, width) => {
      const { model, series } = view();
      const curves = series.map((s) => ({
        s, n: s.rows.length,
        times: s.rows.map((row) => model.trials.number('time_to_goal_s', row)).filter(Number.isFinite).sort((a, b) => a - b),
      })).filter((c) => c.n > 0);
      const last = Math.max(...curves.map((c) => c.times[c.times.length - 1] ?? 0));
      if (curves.length === 0 || !(last > 0)) return null;
      const end = nice(0, Math.min(Math.max(...series.map((s) => s.info.time_limit_s)), last * 1.15)).max;
      /** A share of each curve as steps, from the number of arrivals. */
      const steps = ({ times }: (typeof curves)[number], value: (hits: number) => number): [number, number][] =>
        stairs([[0, value(0)], ...thinned(times.length).map((i) => [times[i] ?? 0, value(i + 1)] as [number, number]), [end, value(times.length)]]);
      const drawn = curves.map((c) => ({ colour: seriesColour(p, c.s.mark), share: steps(c, (hits) => hits / c.n), low: steps(c, (hits) => wilson(hits, c.n).low), high: steps(c, (hits) => wilson(hits, c.n).high) }));
      const bands = curves.length <= kBands || curves.length > kTogether;
      // An invisible line through all times, which the pointer finds.
      const pointer: Option = { type: 'line', data: Array.from({ length: 241 }, (_, i) => [(end * i) / 240, 0]), showSymbol: false, lineStyle: { opacity: 0 }, itemStyle: { opacity: 0 }, silent: true, emphasis: { disabled: true } };
      return {
        note: curves.map((c) => `${c.s.short}: ${integer(c.times.length)} of n = ${integer(c.n)} arrived`).join('; ') + (bands ? '. Bands: pointwise 95 % Wilson.' : '. The data have the 95 % Wilson intervals.'),
        columns: ['controller', 'point', 'time_to_goal_s', 'share_arrived', 'share_low', 'share_high', 'n'],
        rows: curves.flatMap(({ s, times, n }) => times.map((t, i) => {
          const w = wilson(i + 1, n);
          return [s.controller, s.point, t, (i + 1) / n, w.low, w.high, n];
        })),
        ...plots(p, width, {
          groups: curves.map((c) => c.s), most: kTogether, height: 360, behind: [pointer],
          x: () => axis(p, 'time [s]', { min: 0, max: end }), y: shareAxis(p, 0.25), end: (i) => [end, (curves[i]?.times.length ?? 0) / (curves[i]?.n ?? 1)],
          series: (i, alone) => {
            const { colour, share, low, high } = drawn[i]!;
            return [
              ...(alone ? drawn.filter((_, k) => k !== i).map((d) => pathSeries('', d.share, { colour: p.rule, width: 1 }, { silent: true, z: 2 })) : []),
              ...(bands ? [bandSeries(low, high, colour, p.dark ? 0.16 : 0.12)] : []),
              pathSeries(curves[i]!.s.short, share, { colour, width: 2, dash: alone ? 'solid' : dashOf(curves[i]!.s.mark) }, { silent: true, z: 5 }),
            ];
          },
          tooltip: {
            trigger: 'axis', axisPointer: { type: 'line', lineStyle: { color: p.faint } },
            formatter: (items: { axisValue: number }[]) => {
              const t = items[0]?.axisValue ?? 0;
              return tip(`by ${fixed(t, 2)} s`, curves.map((c) => {
                const hits = c.times.filter((time) => time <= t).length;
                const w = wilson(hits, c.n);
                return [c.s.short, `${percent(hits / c.n)}  (${percentRange(w.low, w.high)})`] as const;
              }));
            },
          },
        }),
      };
    },
  };
}
