// A sweep: success over two swept gains as a heat map, and all gains of all points as parallel coordinates.

import { axis, nice, plain, tip, type FigureSpec } from '../chart';
import { along, inkOn, stepOf } from '../colour';
import type { Model } from '../data';
import { choice } from '../dom';
import { integer, percentRange, sizes, upper } from '../format';
import * as state from '../state';
import { gainShares } from './gain_shares';
import { slices } from './slices';
import { gains, intervalOf, isBetter, measure, measureChoice, points, ramp, short, told, valueOf, type Point } from './swept';

function heat(model: Model): FigureSpec {
  const axes = (): [string, string] => {
    const keys = gains(points(model));
    const x = keys.includes(state.get('f.gx')) ? state.get('f.gx') : keys[0] ?? '';
    const y = keys.includes(state.get('f.gy')) && state.get('f.gy') !== x ? state.get('f.gy') : keys.find((key) => key !== x) ?? '';
    return [x, y];
  };
  return {
    id: 'heat',
    title: () => `${upper(measure().name)} over two gains`,
    caption: 'One cell per pair of values, coloured by the bar above. Where other gains were swept too, a cell is the best of its points.',
    empty: 'Two gains with several values each are needed.',
    controls: (redraw) => {
      const keys = gains(points(model)).map((key) => [key, short(key)] as const);
      const [x, y] = axes();
      const pick = (name: string) => (value: string) => { state.set({ [name]: value }); redraw(); };
      return [measureChoice(redraw), ...(keys.length > 2 ? [choice('x', keys, x, pick('f.gx')), choice('y', keys, y, pick('f.gy'))] : [])];
    },
    draw: (p, width) => {
      const all = points(model);
      const [kx, ky] = axes();
      if (ky === '') return null;
      const levels = (key: string): number[] => [...new Set(all.map((point) => point.values.get(key) ?? NaN))].filter(Number.isFinite).sort((a, b) => a - b);
      const [xs, ys] = [levels(kx), levels(ky)];
      if (xs.length * ys.length > 2500) return null;
      const of = measure();
      const { key, write } = of;
      const cells = new Map<string, { at: [number, number]; value: number; point: Point }>();
      for (const point of all) {
        const value = valueOf(point, of);
        const at: [number, number] = [xs.indexOf(point.values.get(kx) ?? NaN), ys.indexOf(point.values.get(ky) ?? NaN)];
        if (!Number.isFinite(value) || at[0] < 0 || at[1] < 0) continue;
        const known = cells.get(at.join());
        if (known === undefined || isBetter(value, known.value, of)) cells.set(at.join(), { at, value, point });
      }
      const list = [...cells.values()];
      if (list.length === 0) return null;
      const range = [Math.min(...list.map((c) => c.value)), Math.max(...list.map((c) => c.value))] as const;
      const ink = (value: number): string => inkOn(along(ramp(p), range[1] > range[0] ? (value - range[0]) / (range[1] - range[0]) : 0));
      // Wide enough for the letters of a rate and of its interval below it.
      const cell = (width - 90) / xs.length;
      const isRate = list.every((c) => intervalOf(c.point, of) !== null);
      const withInterval = isRate && cell > 78;
      const written = (c: (typeof list)[number]): string => (withInterval ? `${write(c.value)}\n{i|${percentRange(...intervalOf(c.point, of)!)}}` : write(c.value));
      const ns = list.map((c) => c.point.row.n);
      const category = (title: string, values: number[], gap: number) => ({
        ...axis(p, short(title), { nameGap: gap }), type: 'category', data: values.map((v) => plain(v)), splitLine: { show: false }, axisLine: { show: false },
      });
      return {
        height: Math.min(620, 150 + Math.max(3, ys.length) * 52),
        note: `n = ${sizes(ns)} trials a point, ${integer(all.length)} points.${withInterval ? ' Below each rate its 95 % Wilson interval.' : isRate ? ' The data have the 95 % Wilson intervals, for which there is no room here.' : ''} The best of many cells looks better than it is.`,
        columns: [short(kx), short(ky), key, 'low', 'high', 'n', 'point'],
        rows: list.map((c) => [xs[c.at[0]] ?? NaN, ys[c.at[1]] ?? NaN, c.value, ...(intervalOf(c.point, of) ?? [null, null]), c.point.row.n, c.point.name]),
        option: {
          grid: { left: 8, right: 16, top: 58, bottom: 8, outerBoundsMode: 'same', outerBoundsContain: 'all' },
          xAxis: category(kx, xs, 30), yAxis: category(ky, ys, 52),
          visualMap: {
            show: true, type: 'continuous', calculable: false, hoverLink: false, orient: 'horizontal', left: 'center', top: 8, itemWidth: 12, itemHeight: Math.min(200, 0.4 * width),
            text: [write(range[1]), write(range[0])], textStyle: { color: p.muted, fontSize: 11.5 },
            min: range[0], max: range[1] > range[0] ? range[1] : range[0] + 1e-9, inRange: { color: ramp(p) },
          },
          tooltip: {
            trigger: 'item',
            formatter: ({ dataIndex }: { dataIndex: number }) => {
              const c = list[dataIndex];
              if (c === undefined) return '';
              return tip(c.point.name, told(c.point, of));
            },
          },
          series: [{
            type: 'heatmap', itemStyle: { borderColor: p.surface, borderWidth: 2, borderRadius: 4 }, emphasis: { disabled: true },
            data: list.map((c) => ({
              value: [...c.at, c.value],
              label: {
                show: cell > 44, formatter: written(c), fontSize: 12,
                color: ink(c.value), rich: { i: { fontSize: 10.5, lineHeight: 15, color: ink(c.value) } },
              },
            })),
          }],
        },
      };
    },
  };
}

function parallel(model: Model): FigureSpec {
  return {
    id: 'parallel',
    title: () => `${upper(measure().name)} over all swept gains`,
    caption: 'One line per point, through its gains to its measure; the stronger the colour, the higher the measure.',
    empty: 'No gain takes several values.',
    controls: (redraw) => [measureChoice(redraw)],
    draw: (p) => {
      const of = measure();
      const { key, name, write } = of;
      const all = points(model).filter((point) => Number.isFinite(valueOf(point, of)));
      const keys = gains(all);
      if (keys.length === 0 || all.length < 2) return null;
      const value = (point: Point): number => valueOf(point, of);
      const result = nice(Math.min(...all.map(value)), Math.max(...all.map(value)));
      const scales = keys.map((gain) => {
        const values = all.map((point) => point.values.get(gain) ?? NaN).filter(Number.isFinite);
        const [low, high] = [Math.min(...values), Math.max(...values)];
        // Gains are usually searched over decades.
        const log = low > 0 && high / low >= 20;
        const at = (v: number): number => (log ? Math.log(v / low) / Math.log(high / low) : (v - low) / (high - low));
        return { name: short(gain), low: plain(low), high: plain(high), at, log };
      });
      const last = { name, low: write(result.min), high: write(result.max), at: (v: number) => (v - result.min) / (result.max - result.min), log: false };
      const ends = [...scales, last];
      const colours = ramp(p).slice(1);
      const colour = (point: Point): string => stepOf(colours, last.at(value(point)));
      const ordered = [...all].sort((a, b) => value(a) - value(b));
      return {
        height: 340,
        note: `${integer(all.length)} points, n = ${sizes(all.map((a) => a.row.n))} trials each.${scales.some((s) => s.log) ? ' Axes over more than a decade are logarithmic.' : ''}`,
        columns: [...keys.map(short), key, 'n', 'point'],
        rows: all.map((point) => [...keys.map((gain) => point.values.get(gain) ?? null), value(point), point.row.n, point.name]),
        option: {
          grid: { left: 50, right: 50, top: 44, bottom: 34 },
          xAxis: {
            type: 'category', boundaryGap: false, position: 'top', data: ends.map((e) => e.name), axisLine: { show: false }, axisTick: { show: false },
            axisLabel: { color: p.ink, fontSize: 12, margin: 20, interval: 0 }, splitLine: { show: true, interval: 0, lineStyle: { color: p.faint, width: 1 } },
          },
          yAxis: { type: 'value', min: 0, max: 1, show: false },
          tooltip: {
            trigger: 'item',
            formatter: ({ seriesIndex }: { seriesIndex: number }) => {
              const point = ordered[seriesIndex];
              if (point === undefined) return '';
              return tip(point.name, told(point, of));
            },
          },
          series: [
            ...ordered.map((point) => ({
              type: 'line', showSymbol: false, symbolSize: 6, triggerEvent: 'line', lineStyle: { width: 1.8, opacity: 0.85, color: colour(point) }, itemStyle: { color: colour(point) },
              data: [...keys.map((gain, i) => scales[i]?.at(point.values.get(gain) ?? NaN) ?? null), last.at(value(point))],
            })),
            ...([0, 1] as const).map((end) => ({
              type: 'scatter', silent: true, symbolSize: 2, itemStyle: { color: 'transparent' }, data: ends.map((_, i) => [i, end]),
              label: { show: true, position: end === 0 ? 'bottom' : 'top', distance: 4, color: p.muted, fontSize: 11, formatter: ({ dataIndex }: { dataIndex: number }) => (end === 0 ? ends[dataIndex]?.low : ends[dataIndex]?.high) ?? '' },
            })),
          ],
        },
      };
    },
  };
}

export function sweep(model: Model): FigureSpec[] {
  state.setDefault('f.measure', 'success_rate');
  return [heat(model), slices(model), gainShares(model), parallel(model)];
}
