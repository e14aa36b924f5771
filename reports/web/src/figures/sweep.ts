// A sweep: success over two swept gains as a heat map, and all gains of all points as parallel coordinates.

import { axis, nice, plain, tip, type FigureSpec } from '../chart';
import { along, inkOn } from '../colour';
import { inSlice, type Model, type SummaryRow } from '../data';
import { choice } from '../dom';
import { fixed, integer, percent, percentRange, seconds, significant, sizes, upper } from '../format';
import * as state from '../state';
import type { Palette } from '../theme';
import { view } from '../view';

interface Point {
  name: string;
  values: Map<string, number>;
  row: SummaryRow;
}

const kMeasures: readonly (readonly [key: keyof SummaryRow, name: string, write: (v: number) => string])[] = [
  ['success_rate', 'success rate', (v) => percent(v)], ['collision_rate', 'collision rate', (v) => percent(v)],
  ['time_to_goal_median_s', 'median time to goal', (v) => seconds(v)], ['manip_mean', 'mean manipulability', (v) => fixed(v, 4)],
  ['clearance_min_m', 'mean least clearance', (v) => `${fixed(v, 3)} m`], ['command_change_mean', 'mean command change', (v) => significant(v)],
];

/** The points of the slice with the numbers that were swept, and their rows of the summary. */
function points(model: Model): Point[] {
  const { slice, family } = view();
  const rows = (family === '' ? model.page.overall : model.page.summary.filter((s) => s.family === family)).filter((r) => inSlice(r, slice));
  return model.page.points.filter((p) => inSlice(p, slice)).flatMap((p) => {
    const values = new Map(Object.entries(p.params).filter((e): e is [string, number] => typeof e[1] === 'number'));
    const row = rows.find((r) => r.controller === p.controller && r.point === p.point);
    return values.size === 0 || row === undefined ? [] : [{ name: p.point || p.controller, values, row }];
  });
}

/** Gains with more than one value. */
function gains(all: readonly Point[]): string[] {
  const keys = [...new Set(all.flatMap((p) => [...p.values.keys()]))];
  return keys.filter((key) => new Set(all.map((p) => p.values.get(key))).size > 1);
}

function measure(): (typeof kMeasures)[number] {
  return kMeasures.find(([key]) => key === state.get('f.measure')) ?? kMeasures[0]!;
}

function ramp(p: Palette): string[] {
  return p.dark ? ['#1d2733', '#24496b', '#3b7fae', '#7fc0d8', '#e8f3e2'] : ['#f3f1ea', '#c9dbe2', '#86b3c9', '#41799f', '#173d63'];
}

function short(key: string): string {
  return key.replace(/^controllers?\./, '');
}

export function isSwept(model: Model): boolean {
  return model.page.points.some((p) => Object.values(p.params).some((v) => typeof v === 'number'));
}

function measureChoice(redraw: () => void): Node {
  return choice('Measure', kMeasures.map(([key, name]) => [key, name] as const), state.get('f.measure'), (value) => { state.set({ 'f.measure': value }); redraw(); });
}

function heat(model: Model): FigureSpec {
  const axes = (): [string, string] => {
    const keys = gains(points(model));
    const x = keys.includes(state.get('f.gx')) ? state.get('f.gx') : keys[0] ?? '';
    const y = keys.includes(state.get('f.gy')) && state.get('f.gy') !== x ? state.get('f.gy') : keys.find((key) => key !== x) ?? '';
    return [x, y];
  };
  return {
    id: 'heat',
    title: () => `${upper(measure()[1])} over two gains`,
    caption: 'One cell per pair of values. Where other gains were swept too, a cell is the best of its points.',
    empty: 'Two gains with several values each are needed.',
    controls: (redraw) => {
      const keys = gains(points(model)).map((key) => [key, short(key)] as const);
      const [x, y] = axes();
      const pick = (name: string) => (value: string) => { state.set({ [name]: value }); redraw(); };
      return [measureChoice(redraw), ...(keys.length > 2 ? [choice('x', keys, x, pick('f.gx')), choice('y', keys, y, pick('f.gy'))] : [])];
    },
    draw: (p) => {
      const all = points(model);
      const [kx, ky] = axes();
      if (ky === '') return null;
      const levels = (key: string): number[] => [...new Set(all.map((point) => point.values.get(key) ?? NaN))].filter(Number.isFinite).sort((a, b) => a - b);
      const [xs, ys] = [levels(kx), levels(ky)];
      if (xs.length * ys.length > 2500) return null;
      const [key, name, write] = measure();
      const lowIsGood = key === 'collision_rate' || key === 'time_to_goal_median_s' || key === 'command_change_mean';
      const cells = new Map<string, { at: [number, number]; value: number; point: Point }>();
      for (const point of all) {
        const value = point.row[key];
        const at: [number, number] = [xs.indexOf(point.values.get(kx) ?? NaN), ys.indexOf(point.values.get(ky) ?? NaN)];
        if (typeof value !== 'number' || at[0] < 0 || at[1] < 0) continue;
        const known = cells.get(at.join());
        if (known === undefined || (lowIsGood ? value < known.value : value > known.value)) cells.set(at.join(), { at, value, point });
      }
      const list = [...cells.values()];
      if (list.length === 0) return null;
      const range = [Math.min(...list.map((c) => c.value)), Math.max(...list.map((c) => c.value))] as const;
      const ink = (value: number): string => inkOn(along(ramp(p), range[1] > range[0] ? (value - range[0]) / (range[1] - range[0]) : 0));
      const isRate = key === 'success_rate' || key === 'collision_rate';
      const interval = (r: SummaryRow): string => (key === 'collision_rate' ? percentRange(r.collision_low, r.collision_high) : percentRange(r.success_low, r.success_high));
      const ns = list.map((c) => c.point.row.n);
      const category = (title: string, values: number[], gap: number) => ({
        ...axis(p, short(title), { nameGap: gap }), type: 'category', data: values.map((v) => plain(v)), splitLine: { show: false }, axisLine: { show: false },
      });
      return {
        height: Math.min(620, 150 + Math.max(3, ys.length) * 52),
        note: `n = ${sizes(ns)} trials a point, ${integer(all.length)} points.${isRate ? ' Below each rate its 95 % Wilson interval.' : ''} The best of many cells looks better than it is.`,
        columns: [short(kx), short(ky), key, 'success_low', 'success_high', 'n', 'point'],
        rows: list.map((c) => [xs[c.at[0]] ?? NaN, ys[c.at[1]] ?? NaN, c.value, c.point.row.success_low, c.point.row.success_high, c.point.row.n, c.point.name]),
        option: {
          grid: { left: 8, right: 16, top: 58, bottom: 8, outerBoundsMode: 'same', outerBoundsContain: 'all' },
          xAxis: category(kx, xs, 30), yAxis: category(ky, ys, 52),
          visualMap: {
            show: true, type: 'continuous', calculable: false, hoverLink: false, orient: 'horizontal', left: 'center', top: 8, itemWidth: 12, itemHeight: 200,
            text: [write(range[1]), `${name}  ${write(range[0])}`], textStyle: { color: p.muted, fontSize: 11.5 },
            min: range[0], max: range[1] > range[0] ? range[1] : range[0] + 1e-9, inRange: { color: ramp(p) },
          },
          tooltip: {
            trigger: 'item',
            formatter: ({ dataIndex }: { dataIndex: number }) => {
              const c = list[dataIndex];
              if (c === undefined) return '';
              const r = c.point.row;
              return tip(c.point.name, [[name, write(c.value)], ['success', `${percent(r.success_rate)} (${percentRange(r.success_low, r.success_high)})`], ['n', integer(r.n)]]);
            },
          },
          series: [{
            type: 'heatmap', itemStyle: { borderColor: p.surface, borderWidth: 2, borderRadius: 4 }, emphasis: { disabled: true },
            data: list.map((c) => ({
              value: [...c.at, c.value],
              label: {
                show: xs.length <= 14, formatter: isRate && xs.length <= 7 ? `${write(c.value)}\n{i|${interval(c.point.row)}}` : write(c.value), fontSize: 12,
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
    title: () => `${upper(measure()[1])} over all swept gains`,
    caption: 'One line per point, through its gains to its measure; the stronger the colour, the higher the measure.',
    empty: 'No gain takes several values.',
    controls: (redraw) => [measureChoice(redraw)],
    draw: (p) => {
      const [key, name, write] = measure();
      const all = points(model).filter((point) => typeof point.row[key] === 'number');
      const keys = gains(all);
      if (keys.length === 0 || all.length < 2) return null;
      const value = (point: Point): number => point.row[key] as number;
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
      const colour = (point: Point): string => colours[Math.min(colours.length - 1, Math.floor(last.at(value(point)) * colours.length))] ?? p.ink;
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
              return tip(point.name, [[name, write(value(point))], ['success', `${percent(point.row.success_rate)} (${percentRange(point.row.success_low, point.row.success_high)})`], ['n', integer(point.row.n)]]);
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
  return [heat(model), parallel(model)];
}
