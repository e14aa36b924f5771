// A sweep: success over two swept gains as a heat map, and in slices along each gain.

import { axis, gainAxis, gridBox, nice, pathSeries, plain, smallMultiples, tip, tipOf, whiskers, type FigureSpec } from '../chart';
import { along, inkOn } from '../colour';
import { integer, percentRange, plural, sizes, upper } from '../format';
import * as state from '../state';
import { seriesColour } from '../theme';
import { gains, intervalOf, isBetter, kMeasureChoice, measure, measured, points, short, told, valueOf, type Point } from './swept';

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

/** The gains along x and y: as chosen, else the first two. */
function axes(): [string, string] {
  const keys = gains(points());
  const x = keys.find((key) => key === state.get('f.gx')) ?? keys[0] ?? '';
  return [x, keys.find((key) => key === state.get('f.gy') && key !== x) ?? keys.find((key) => key !== x) ?? ''];
}

function gainOptions(): [string, string][] {
  const keys = gains(points());
  return keys.length > 2 ? keys.map((key) => [key, short(key)]) : [];
}

export function heat(): FigureSpec {
  return {
    id: 'heat',
    title: () => `${upper(measure().name)} over two gains`,
    caption: 'One cell per pair of values, coloured by the bar above. Where other gains were swept too, a cell is the best of its points.',
    empty: 'Two gains with several values each are needed.',
    choices: [kMeasureChoice, { key: 'f.gx', label: 'x', options: gainOptions, value: () => axes()[0] }, { key: 'f.gy', label: 'y', options: gainOptions, value: () => axes()[1] }],
    draw: (p, width) => {
      const of = measure();
      const all = points();
      const [kx, ky] = axes();
      if (ky === '') return null;
      const levels = (key: string): number[] => [...new Set(all.map((point) => point.values.get(key) ?? NaN))].filter(Number.isFinite).sort((a, b) => a - b);
      const [xs, ys] = [levels(kx), levels(ky)];
      if (xs.length * ys.length > 2500) return null;
      const cells = new Map<string, { at: [number, number]; value: number; point: Point }>();
      for (const point of measured()) {
        const value = valueOf(point.row, of);
        const at: [number, number] = [xs.indexOf(point.values.get(kx) ?? NaN), ys.indexOf(point.values.get(ky) ?? NaN)];
        const known = cells.get(at.join());
        if (at[0] >= 0 && at[1] >= 0 && (known === undefined || isBetter(value, known.value, of))) cells.set(at.join(), { at, value, point });
      }
      const list = [...cells.values()];
      if (list.length === 0) return null;
      const [low, high] = [Math.min(...list.map((c) => c.value)), Math.max(...list.map((c) => c.value))];
      const ink = (value: number): string => inkOn(along(p.ramp, high > low ? (value - low) / (high - low) : 0));
      // Wide enough for the letters of a rate and of its interval below it.
      const cell = (width - 90) / xs.length;
      const isRate = list.every((c) => intervalOf(c.point.row, of) !== null);
      const withInterval = isRate && cell > 78;
      const category = (key: string, values: number[], nameGap: number) => {
        const { axisLabel: { formatter, ...label }, ...more } = axis(p, short(key), { nameGap }) as { axisLabel: { formatter: unknown } };
        return { ...more, axisLabel: label, type: 'category', data: values.map(plain), splitLine: { show: false }, axisLine: { show: false } };
      };
      return {
        height: Math.min(620, 150 + Math.max(3, ys.length) * 52),
        note: `n = ${sizes(list.map((c) => c.point.row.n))} trials a point, ${integer(all.length)} points.${withInterval ? ' Below each rate its 95 % Wilson interval.' : isRate ? ' The data have the 95 % Wilson intervals, for which there is no room here.' : ''} The best of many cells looks better than it is.`,
        columns: [short(kx), short(ky), of.key, 'low', 'high', 'n', 'point'],
        rows: list.map((c) => [xs[c.at[0]] ?? NaN, ys[c.at[1]] ?? NaN, c.value, ...(intervalOf(c.point.row, of) ?? [null, null]), c.point.row.n, c.point.name]),
        option: {
          grid: gridBox(58, 16, 8), xAxis: category(kx, xs, 30), yAxis: category(ky, ys, 52),
          visualMap: {
            show: true, type: 'continuous', calculable: false, hoverLink: false, orient: 'horizontal', left: 'center', top: 8, itemWidth: 12, itemHeight: Math.min(200, 0.4 * width),
            text: [of.write(high), of.write(low)], textStyle: { color: p.muted, fontSize: 11.5 }, min: low, max: high > low ? high : low + 1e-9, inRange: { color: p.ramp },
          },
          tooltip: tipOf((point: Point) => tip(point.name, told(point, of))),
          series: [{
            type: 'heatmap', itemStyle: { borderColor: p.surface, borderWidth: 2, borderRadius: 4 }, emphasis: { disabled: true },
            data: list.map((c) => ({
              value: [...c.at, c.value], of: c.point,
              label: {
                show: cell > 44, fontSize: 12, color: ink(c.value), rich: { i: { fontSize: 10.5, lineHeight: 15, color: ink(c.value) } },
                formatter: withInterval ? `${of.write(c.value)}\n{i|${percentRange(...intervalOf(c.point.row, of)!)}}` : of.write(c.value),
              },
            })),
          }],
        },
      };
    },
  };
}
