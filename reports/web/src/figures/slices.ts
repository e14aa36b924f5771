// A sweep in slices: the measure along each swept gain, all else as at the best point.

import { axis, gainAxis, nice, pathSeries, plain, smallMultiples, tip, tipOf, whiskers, type FigureSpec } from '../chart';
import { integer, plural, sizes, upper } from '../format';
import { seriesColour } from '../theme';
import { gains, intervalOf, isBetter, kMeasureChoice, measure, measured, short, told, valueOf, type Point } from './swept';

/** Points that differ from `best` in `gain` alone, itself among them, by their value of it. */
function through(all: readonly Point[], best: Point, gain: string, others: readonly string[]): Point[] {
  const value = (point: Point): number => point.values.get(gain) ?? NaN;
  return all.filter((point) => Number.isFinite(value(point)) && others.every((key) => key === gain || point.values.get(key) === best.values.get(key))).sort((a, b) => value(a) - value(b));
}

export function slices(): FigureSpec {
  return {
    id: 'slices',
    title: () => `${upper(measure().name)} along each gain`,
    caption: 'A plot per swept gain. The line leads through the best point (filled), all other gains as there; bars are 95 % intervals of rates, faint dots all other points.',
    empty: 'No gain takes several values.',
    choices: [kMeasureChoice],
    draw: (p, width) => {
      const of = measure();
      const all = measured();
      const keys = gains(all);
      const [first] = all;
      if (keys.length === 0 || first === undefined) return null;
      const value = (point: Point): number => valueOf(point.row, of);
      const best = all.reduce((a, b) => (isBetter(value(b), value(a), of) ? b : a), first);
      const lines = keys.map((key) => ({ key, line: through(all, best, key, keys), axis: gainAxis(p, all.map((point) => point.values.get(key) ?? NaN).filter(Number.isFinite), 240) }));
      const isRate = intervalOf(best.row, of) !== null;
      const seen = all.map(value);
      const range = isRate ? { min: 0, max: 1, interval: 0.25 } : nice(Math.min(...seen), Math.max(...seen), 3);
      const colour = seriesColour(p, 0);
      return {
        note: `n = ${sizes(all.map((point) => point.row.n))} trials a point, ${plural(all.length, 'point')}; the best is ${best.name}, of ${integer(all.length)}: it looks better on the worlds that chose it than it is.`,
        columns: ['gain', 'value', of.key, 'low', 'high', 'n', 'point', 'in_slice'],
        rows: lines.flatMap(({ key, line }) => all.map((point) => [short(key), point.values.get(key) ?? null, value(point), ...(intervalOf(point.row, of) ?? [null, null]), point.row.n, point.name, Number(line.includes(point))])),
        ...smallMultiples(width, lines.map(({ key }) => ({ title: short(key), colour: p.ink })), (place) => lines[place]!.axis.option,
          axis(p, '', range, (v) => (isRate ? `${Math.round(100 * v)} %` : plain(v))), (place) => {
            const { key, line, axis: { at } } = lines[place]!;
            const x = (point: Point): number => at(point.values.get(key) ?? NaN);
            const dots = (shown: readonly Point[], style: (point: Point) => object) => shown.map((point) => ({ value: [x(point), value(point)], of: point, itemStyle: style(point) }));
            return [
              { type: 'scatter', symbolSize: 5, z: 2, data: dots(all.filter((point) => !line.includes(point) && Number.isFinite(x(point))), () => ({ color: p.faint, opacity: 0.55 })) },
              pathSeries('', line.map((point) => [x(point), value(point)] as const), { colour, width: 1.8 }),
              whiskers(line.flatMap((point) => { const interval = intervalOf(point.row, of); return interval === null ? [] : [[x(point), ...interval]]; }), colour),
              { type: 'scatter', symbolSize: 8, z: 5, data: dots(line, (point) => ({ color: point === best ? colour : p.surface, borderColor: colour, borderWidth: 1.8 })) },
            ];
          }, tipOf((point: Point) => tip(point.name, told(point, of)))),
      };
    },
  };
}
