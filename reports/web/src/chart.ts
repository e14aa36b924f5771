// What all figures share: their description, axes, legends, marks.

import { BarChart, BoxplotChart, CustomChart, HeatmapChart, LineChart, ScatterChart } from 'echarts/charts';
import {
  AriaComponent, GridComponent, LegendComponent, TitleComponent, TooltipComponent, VisualMapComponent,
} from 'echarts/components';
import * as echarts from 'echarts/core';
import { CanvasRenderer, SVGRenderer } from 'echarts/renderers';

import { h } from './dom';
import type { Palette } from './theme';

echarts.use([
  BarChart, BoxplotChart, CustomChart, HeatmapChart, LineChart, ScatterChart, AriaComponent, GridComponent,
  LegendComponent, TitleComponent, TooltipComponent, VisualMapComponent, CanvasRenderer, SVGRenderer,
]);

export type Option = Record<string, unknown>;

export interface Drawing {
  option: Option;
  /** What the figure rests on: number of trials, interval. */
  note: string;
  columns: string[];
  rows: (string | number | null)[][];
  height?: number;
}

export interface FigureSpec {
  id: string;
  /** Names the metric; a function where that is chosen. */
  title: string | (() => string);
  /** One sentence on how to read it. */
  caption: string | (() => string);
  controls?: (redraw: () => void) => Node[];
  /** null: there is nothing to show, and `empty` says why. */
  draw: (palette: Palette, width: number) => Drawing | null;
  empty: string;
  /** What must be read before the first drawing. */
  prepare?: () => Promise<void>;
  /** A mark was clicked; `data` is its datum, undefined for a line. */
  click?: (data: unknown, mark: { seriesIndex: number; dataIndex: number }) => void;
}

/** Without double quotes: the SVG renderer writes it into an attribute as it is. */
export const kFont = "'Inter Variable', Inter, system-ui, 'Segoe UI', sans-serif";

/** Texts, lines and tooltip that all figures share. */
export function base(p: Palette): Option {
  return {
    animationDuration: 250, animationDurationUpdate: 200,
    textStyle: { fontFamily: kFont, color: p.muted, fontSize: 12 },
    backgroundColor: 'transparent',
    tooltip: {
      confine: true, backgroundColor: p.surface, borderColor: p.rule, borderWidth: 1, padding: [8, 10],
      textStyle: { color: p.ink, fontSize: 12, fontFamily: kFont },
      extraCssText: 'box-shadow: 0 4px 18px rgba(0,0,0,.14); border-radius: 6px; max-width: 320px; white-space: normal',
    },
    grid: { left: 8, right: 16, top: 34, bottom: 8, outerBoundsMode: 'same', outerBoundsContain: 'axisLabel' },
  };
}

/** Height of a legend of these names in a plot so wide, by the width of its letters. */
export function legendHeight(names: readonly string[], width: number): number {
  let rows = 1;
  let x = 0;
  for (const name of names) {
    const wide = Math.min(width, 36 + 6.9 * name.length);
    if (x > 0 && x + wide > width) {
      rows += 1;
      x = 0;
    }
    x += wide;
  }
  return 12 + 22 * rows;
}

export function legend(p: Palette, names: string[]): Option {
  return {
    data: names, top: 0, left: 0, icon: 'roundRect', itemWidth: 14, itemHeight: 8, itemGap: 16, type: 'plain',
    textStyle: { color: p.muted, fontFamily: kFont, fontSize: 12 }, selectedMode: false,
  };
}

export function axis(p: Palette, name: string, more: Option = {}): Option {
  return {
    type: 'value', name, nameLocation: 'middle', nameGap: 30, nameTextStyle: { color: p.muted, fontSize: 12 },
    axisLabel: { color: p.muted, fontSize: 11 }, axisLine: { show: true, lineStyle: { color: p.rule } },
    axisTick: { show: false }, splitLine: { lineStyle: { color: p.rule, width: 1 } }, ...more,
  };
}

/** In a plot narrower than this names and numbers have less room [px]. */
export const kNarrow = 560;

/** An axis of shares; in a narrow plot with fewer numbers. */
export function shareAxis(p: Palette, width: number, more: Option = {}): Option {
  return axis(p, '', { min: 0, max: 1, interval: width < kNarrow ? 0.5 : 0.2, axisLabel: { color: p.muted, formatter: (v: number) => `${Math.round(100 * v)} %` }, ...more });
}

/** Least height of a row of rowAxis() in a narrow plot, where families stand below names [px]. */
export const kTwoLines = 34;

/** An upright axis of rows, each named by its controller and, where there are several, its family of worlds: beside the name, in a narrow plot below it. */
export function rowAxis(p: Palette, rows: readonly { name: string; family: string }[], width: number, fontSize = 12.5): Option {
  const narrow = width < kNarrow;
  return {
    type: 'category', inverse: true, data: rows.map((_, i) => String(i)), axisLine: { show: false }, axisTick: { show: false }, splitLine: { show: false },
    axisLabel: {
      color: p.ink, fontSize: narrow ? Math.min(12, fontSize) : fontSize, fontFamily: kFont, interval: 0, align: 'right', width: narrow ? 0.44 * width : Math.min(320, 0.4 * width), overflow: 'truncate',
      formatter: (place: string) => {
        const { name = '', family = '' } = rows[Number(place)] ?? {};
        return family === '' ? name : `${name}${narrow ? '\n' : '  '}{f|${family}}`;
      },
      rich: { f: { color: p.muted, fontSize: narrow ? 11 : 12 } },
    },
  };
}

/** Round limits around [low, high] and the step between about `count` marks. */
export function nice(low: number, high: number, count = 6): { min: number; max: number; interval: number } {
  const span = high > low ? high - low : Math.abs(high) || 1;
  const rough = span / count;
  const power = 10 ** Math.floor(Math.log10(rough));
  const interval = ([1, 2, 2.5, 5, 10].find((s) => s * power >= rough) ?? 10) * power;
  const min = Math.floor(low / interval + 1e-9) * interval;
  const max = Math.ceil(high / interval - 1e-9) * interval;
  return { min, max: max > min ? max : min + interval, interval };
}

/** Labels of a nice() axis, without the digits that rounding adds. */
export function plain(value: number): string {
  return String(Number(value.toPrecision(6))).replace('-', '\u2212');
}

/** A tooltip's content: rows of name and value, as nodes, so that names stay text. */
export function tip(head: string, rows: readonly (readonly [string, string])[], colour?: string): HTMLElement {
  return h('div', { class: 'tip' },
    h('strong', colour === undefined ? null : { style: `--c:${colour}`, class: 'dotted' }, head),
    ...rows.map(([name, value]) => h('div', null, h('span', null, name), h('b', null, value))));
}

/** Whiskers for a custom series: data [x, low, high] (vertical) or [low, high, y] (horizontal). */
export function whisker(colour: string, horizontal: boolean, width = 1.5) {
  return (_: unknown, api: { value: (i: number) => number; coord: (p: number[]) => number[] }): Option => {
    const [a, b] = horizontal
      ? [api.coord([api.value(0), api.value(2)]), api.coord([api.value(1), api.value(2)])]
      : [api.coord([api.value(0), api.value(1)]), api.coord([api.value(0), api.value(2)])];
    const [x1 = 0, y1 = 0] = a ?? [];
    const [x2 = 0, y2 = 0] = b ?? [];
    return { type: 'line', shape: { x1, y1, x2, y2 }, style: { stroke: colour, lineWidth: width } };
  };
}

interface CustomApi { coord: (point: number[]) => number[] }

/** From each point level to the next one's x, then straight up or down to it. */
export function stairs(points: readonly (readonly [number, number])[]): [number, number][] {
  const out: [number, number][] = [];
  for (const [x, y] of points) {
    const last = out[out.length - 1];
    if (last !== undefined && last[1] !== y) out.push([x, last[1]]);
    out.push([x, y]);
  }
  return out;
}

/**
 * A series that draws `points` as one path, every corner of it. ECharts' own line leaves out corners less than 0.7 pixels
 * from the one before, so that the riser of a low step is lost and the level stretch after it drawn aslant.
 */
export function pathSeries(name: string, points: readonly (readonly [number, number])[], style: { colour: string; width: number; dash?: unknown; opacity?: number }, more: Option = {}): Option {
  return {
    name, type: 'custom', clip: true, data: points.length === 0 ? [] : [[...(points[0] ?? [0, 0])]], encode: { x: 0, y: 1 }, itemStyle: { color: style.colour },
    renderItem: (_: unknown, api: CustomApi) => ({
      type: 'polyline', shape: { points: points.map(([x, y]) => api.coord([x, y])) },
      style: { stroke: style.colour, fill: 'none', lineWidth: style.width, lineDash: style.dash === 'solid' ? undefined : style.dash, opacity: style.opacity ?? 1, lineJoin: 'miter' },
    }),
    ...more,
  };
}

/** The area between two such paths over the same x. */
export function bandSeries(lower: readonly (readonly [number, number])[], upper: readonly (readonly [number, number])[], colour: string, opacity: number): Option {
  const outline = [...upper, ...[...lower].reverse()];
  return {
    type: 'custom', clip: true, silent: true, tooltip: { show: false }, data: outline.length === 0 ? [] : [[...(outline[0] ?? [0, 0])]], encode: { x: 0, y: 1 },
    renderItem: (_: unknown, api: CustomApi) => ({ type: 'polygon', shape: { points: outline.map(([x, y]) => api.coord([x, y])) }, style: { fill: colour, opacity } }),
  };
}

/**
 * How curves bear their names: beside their right ends, in so much `room` [px]; where that would leave the plot too little, as a
 * legend above it, and `room` is 0.
 */
export function curveNames(p: Palette, names: readonly string[], width: number): { room: number; grid: Option; option: Option; above: number } {
  const wanted = 26 + 7.4 * Math.max(...names.map((name) => name.length));
  const beside = wanted <= 0.36 * width;
  const above = beside ? 0 : legendHeight(names, width);
  return {
    room: beside ? wanted : 0, above,
    grid: { left: 8, right: beside ? wanted : 26, top: above + 14, bottom: 8, outerBoundsMode: 'same', outerBoundsContain: 'all' },
    option: beside ? {} : { legend: legend(p, [...names]) },
  };
}

/** Height of a label beside a curve [px]. */
const kLabel = 15;
/** Between the last mark and the labels [px]. */
const kBeside = 9;

/** Names right of the ends of curves, in the room of curveNames(), moved apart where they would overlap; `ends` at [x, y] in data. */
export function endLabels(ends: readonly { name: string; x: number; y: number; colour: string }[], room: number): Option[] {
  return room === 0 ? [] : [{
    type: 'custom', clip: false, silent: true, tooltip: { show: false }, z: 6, data: ends.length === 0 ? [] : [[ends[0]?.x ?? 0, ends[0]?.y ?? 0]], encode: { x: 0, y: 1 },
    renderItem: (_: unknown, api: CustomApi) => {
      const placed = ends.map((e) => { const [x = 0, y = 0] = api.coord([e.x, e.y]); return { e, x, y, at: y }; }).sort((a, b) => a.y - b.y);
      const right = Math.max(...placed.map(({ x }) => x));   // one edge, clear of the marks of all
      for (let i = 1; i < placed.length; ++i) placed[i]!.at = Math.max(placed[i]!.at, placed[i - 1]!.at + kLabel);
      for (let i = placed.length - 1, below = (placed[placed.length - 1]?.y ?? 0) + kLabel; i >= 0; --i) {   // not pushed below the last curve's end
        placed[i]!.at = Math.min(placed[i]!.at, below);
        below = placed[i]!.at - kLabel;
      }
      return {
        type: 'group',
        children: placed.map(({ e, at }) => ({ type: 'text', x: right + kBeside, y: at, style: { text: e.name, fill: e.colour, font: `600 12px ${kFont}`, align: 'left', verticalAlign: 'middle', width: room - 12, overflow: 'truncate' } })),
      };
    },
  }];
}

/** What differs between plots of the same kind side by side. */
interface Part { title: string; colour: string }

/** The axis of a gain, with the values that were tried as its marks; over a decade and more it is logarithmic. `at` places a value. */
export function gainAxis(p: Palette, values: readonly number[], width: number): { at: (v: number) => number; log: boolean; option: Option } {
  const levels = [...new Set(values)].sort((a, b) => a - b);
  const [low = 0, high = 0] = [levels[0], levels[levels.length - 1]];
  const log = low > 0 && high / low >= 10;
  const at = (v: number): number => (log ? Math.log10(v) : v);
  const room = Math.max(2, Math.floor(width / 46));
  // Of many values the ends and some between.
  const marks = levels.length <= room ? levels : [...new Set(Array.from({ length: room }, (_, i) => levels[Math.round((i * (levels.length - 1)) / (room - 1))] ?? low))];
  const edge = high > low ? 0.06 * (at(high) - at(low)) : Math.abs(at(low)) || 1;
  const custom = { customValues: marks.map(at) };
  return {
    at, log,
    option: axis(p, '', {
      min: at(low) - edge, max: at(high) + edge, splitLine: { show: false }, axisTick: { show: true, lineStyle: { color: p.faint }, ...custom },
      axisLabel: { color: p.muted, formatter: (v: number) => plain(Number((log ? 10 ** v : v).toPrecision(3))), ...custom },
    }),
  };
}

/** Room on the left of plots side by side for the numbers of their common axis [px]. */
const kMargin = 58;
/** And on the right for half of the last number below it. */
const kRight = 28;

/**
 * A plot for each part under its title, all with the same y axis and, unless `xAxis` gives each its own, the same x axis;
 * `series` gives what each shows.
 */
export function smallMultiples(width: number, parts: readonly Part[], xAxis: Option | ((place: number) => Option), yAxis: Option, series: (place: number) => Option[], tooltip: Option = { show: false }): { height: number; option: Option } {
  const columns = Math.max(1, Math.min(4, parts.length, Math.floor((width - kMargin) / 200)));
  const rows = Math.ceil(parts.length / columns);
  const [high, above, gap, between] = [118, 30, 28, 22];
  const wide = Math.max(80, Math.min(420, (width - kMargin - kRight - (columns - 1) * between) / columns));
  const grid = parts.map((_, i) => ({
    left: kMargin + (i % columns) * (wide + between), width: wide, top: above + Math.floor(i / columns) * (high + above + gap), height: high, outerBoundsMode: 'none',
  }));
  const line = { ...(yAxis['axisLine'] as Option | undefined), onZero: false };
  const bottom = (i: number): boolean => i + columns >= parts.length;
  const label = (of: Option, more: Option): Option => ({ ...(of['axisLabel'] as Option | undefined), fontSize: 10.5, hideOverlap: true, ...more });
  return {
    height: rows * (high + above + gap) + 14,
    option: {
      grid, tooltip,
      title: parts.map((part, i) => ({
        text: part.title, left: grid[i]?.left, top: (grid[i]?.top ?? 0) - 22, padding: 0,
        textStyle: { color: part.colour, fontSize: 12, fontWeight: 600, fontFamily: kFont, width: wide, overflow: 'truncate' },
      })),
      xAxis: parts.map((_, i) => {
        const own = typeof xAxis === 'function' ? xAxis(i) : { ...xAxis, name: bottom(i) ? xAxis['name'] : '' };
        return { splitNumber: 3, ...own, gridIndex: i, axisLine: line, axisLabel: label(own, {}) };
      }),
      yAxis: parts.map((_, i) => ({ splitNumber: 3, ...yAxis, gridIndex: i, axisLine: line, name: i % columns === 0 ? yAxis['name'] : '', nameGap: 36, axisLabel: label(yAxis, { show: i % columns === 0 }) })),
      series: parts.flatMap((_, i) => series(i).map((s) => ({ ...s, xAxisIndex: i, yAxisIndex: i }))),
    },
  };
}

export function captionOf(spec: FigureSpec): string {
  return typeof spec.caption === 'string' ? spec.caption : spec.caption();
}

export function titleOf(spec: FigureSpec): string {
  return typeof spec.title === 'string' ? spec.title : spec.title();
}
