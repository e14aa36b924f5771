// Common parts of all figures: their description, axes, legends, marks, and how groups share one plot or get one each.

import { BarChart, CustomChart, HeatmapChart, LineChart, ScatterChart } from 'echarts/charts';
import { AriaComponent, GridComponent, LegendComponent, TitleComponent, TooltipComponent, VisualMapComponent } from 'echarts/components';
import * as echarts from 'echarts/core';
import { CanvasRenderer, SVGRenderer } from 'echarts/renderers';

import { h } from './dom';
import type { Table } from './format';
import { seriesInk, type Palette } from './theme';

echarts.use([
  BarChart, CustomChart, HeatmapChart, LineChart, ScatterChart, AriaComponent, GridComponent, LegendComponent, TitleComponent, TooltipComponent,
  VisualMapComponent, CanvasRenderer, SVGRenderer,
]);

export type Option = Record<string, unknown>;

interface Drawing extends Table {
  option: Option;
  /** Evidence behind the figure: number of trials, kind of interval. */
  note: string;
  height?: number;
}

/** A list above a figure to choose from; the choice is kept in the address under `key`. */
export interface Choice {
  key: string;
  label: string;
  options: () => readonly (readonly [value: string, text: string])[];
  /** The chosen value, where the address alone does not determine it. */
  value?: () => string;
}

export interface FigureSpec {
  id: string;
  /** Names the metric; a function where that is chosen. */
  title: string | (() => string);
  /** One sentence on how to read it. */
  caption: string | (() => string);
  choices?: readonly Choice[];
  /** null: there is nothing to show, and `empty` says why. */
  draw: (palette: Palette, width: number) => Drawing | null;
  empty: string;
  /** Marks the trial that is chosen. */
  linked?: boolean;
  /** A mark was clicked; `of` is the thing that it shows. */
  click?(of: unknown): void;
}

export function textOf(words: string | (() => string)): string {
  return typeof words === 'string' ? words : words();
}

/** Without double quotes: the SVG renderer writes it into an attribute as it is. */
export const kFont = "'Inter Variable', Inter, system-ui, 'Segoe UI', sans-serif";

/** Box of a plot in its figure [px], names and numbers of the axes included. */
export function gridBox(top = 8, right = 24, left = 4): Option {
  return { left, right, top, bottom: 8, outerBoundsMode: 'same', outerBoundsContain: 'all' };
}

/** Texts, lines and tooltip that all figures share. */
export function base(p: Palette): Option {
  return {
    animationDuration: 250, animationDurationUpdate: 200,
    textStyle: { fontFamily: kFont, color: p.muted, fontSize: 12 },
    backgroundColor: 'transparent',
    tooltip: {
      trigger: 'item', confine: true, backgroundColor: p.surface, borderColor: p.rule, borderWidth: 1, padding: [8, 10],
      textStyle: { color: p.ink, fontSize: 12, fontFamily: kFont },
      extraCssText: 'box-shadow: 0 4px 18px rgba(0,0,0,.14); border-radius: 6px; max-width: 320px; white-space: normal',
    },
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

export function legend(p: Palette, names: readonly string[]): Option {
  return {
    data: names, top: 0, left: 0, icon: 'roundRect', itemWidth: 14, itemHeight: 8, itemGap: 16, type: 'plain',
    textStyle: { color: p.muted, fontFamily: kFont, fontSize: 12 }, selectedMode: false,
  };
}

/** An axis of numbers, written by `write`. */
export function axis(p: Palette, name: string, more: Option = {}, write: (v: number) => string = plain): Option {
  return {
    type: 'value', name, nameLocation: 'middle', nameGap: 28, nameTextStyle: { color: p.muted, fontSize: 12 }, axisLine: { show: true, lineStyle: { color: p.rule } },
    axisTick: { show: false }, splitLine: { lineStyle: { color: p.rule, width: 1 } }, ...more,
    axisLabel: { color: p.muted, fontSize: 11, hideOverlap: true, formatter: write, ...more['axisLabel'] as Option | undefined },
  };
}

/** A plot narrower than this shortens names and numbers [px]. */
export const kNarrow = 560;

export function marksIn(width: number): number {
  return width < 300 ? 3 : width < kNarrow ? 4 : 7;
}

export function shareAxis(p: Palette, interval: number, more: Option = {}): Option {
  return axis(p, '', { min: 0, max: 1, interval, ...more }, (v) => `${plain(100 * v)} %`);
}

/** A row of rowAxis(): its series, and its family of worlds where there are several. */
interface AxisRow { name: string; family?: string }

/** Height of a line of a row's name in a narrow plot [px]. */
const kLine = 14;

/** The lines that name a row in a narrow plot: controller, point, family. */
function linesOf({ name, family = '' }: AxisRow): string[] {
  return [...name.split(' \u00b7 '), family].filter((line) => line !== '');
}

/** Height of a row [px]: `least`, in a narrow plot as much as its lines need. */
export function rowHeight(rows: readonly AxisRow[], width: number, least: number): number {
  return width < kNarrow ? Math.max(least, 6 + kLine * Math.max(...rows.map((row) => linesOf(row).length))) : least;
}

/** An upright axis of rows, with families beside their names; in a narrow plot all that names a row stands in lines. */
export function rowAxis(p: Palette, rows: readonly AxisRow[], width: number, fontSize = 12.5): Option {
  const narrow = width < kNarrow;
  return {
    type: 'category', inverse: true, data: rows.map((_, i) => String(i)), axisLine: { show: false }, axisTick: { show: false }, splitLine: { show: false },
    axisLabel: {
      color: p.ink, fontSize: narrow ? Math.min(12, fontSize) : fontSize, fontFamily: kFont, interval: 0, align: 'right', width: narrow ? 0.44 * width : Math.min(320, 0.4 * width), overflow: 'truncate', lineHeight: kLine,
      formatter: (place: string) => {
        const row = rows[Number(place)] ?? { name: '' };
        if (!narrow) return row.family === undefined || row.family === '' ? row.name : `${row.name}  {f|${row.family}}`;
        const [first = '', ...more] = linesOf(row);
        return [first, ...more.map((line) => `{f|${line}}`)].join('\n');
      },
      rich: { f: { color: p.muted, fontSize: narrow ? 11 : 12, lineHeight: kLine } },
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

/** A tooltip of marks whose data carry `of`, the thing that they show. */
export function tipOf<T>(content: (of: T) => HTMLElement): Option {
  return { formatter: ({ data }: { data?: { of?: T } }) => (data?.of === undefined ? '' : content(data.of)) };
}

interface CustomApi { value: (i: number) => number; coord: (point: number[]) => number[] }

const kUnseen = { silent: true, tooltip: { show: false } };

/** Bars of intervals: data [x, low, high], or `level` [low, high, y]. The colour may be each bar's own. */
export function whiskers(data: readonly (readonly number[])[], colour: string | ((place: number) => string), { level = false, width = 1.5, z = 3 } = {}): Option {
  return {
    type: 'custom', ...kUnseen, z, data, encode: level ? { x: [0, 1], y: 2 } : { x: 0, y: [1, 2] },
    renderItem: (params: { dataIndex: number }, api: CustomApi): Option => {
      const [a, b, c] = [api.value(0), api.value(1), api.value(2)];
      const [[x1 = 0, y1 = 0], [x2 = 0, y2 = 0]] = level ? [api.coord([a, c]), api.coord([b, c])] : [api.coord([a, b]), api.coord([a, c])];
      return { type: 'line', shape: { x1, y1, x2, y2 }, style: { stroke: typeof colour === 'string' ? colour : colour(params.dataIndex), lineWidth: width } };
    },
  };
}

export function stackedBars(p: Palette, width: number, rows: readonly AxisRow[], parts: readonly { name: string; colour: string; data: Option[]; label?: Option }[], xAxis: Option, tooltip: Option): { height: number; option: Option } {
  const names = parts.map(({ name }) => name);
  const top = legendHeight(names, width);
  return {
    height: (xAxis['name'] === '' ? 34 : 60) + top + rows.length * rowHeight(rows, width, rows.length <= 12 ? 38 : 26),
    option: {
      legend: legend(p, names), grid: gridBox(top, 20), xAxis, yAxis: rowAxis(p, rows, width), tooltip,
      series: parts.map(({ colour, ...part }) => ({
        ...part, type: 'bar', stack: 'all', barWidth: '68%', barCategoryGap: '20%', emphasis: { disabled: true }, itemStyle: { color: colour, borderColor: p.surface, borderWidth: 1 },
      })),
    },
  };
}

/** A broken straight line to compare marks with. */
export function ruler(p: Palette, from: readonly (number | string)[], to: readonly (number | string)[], more: Option = {}): Option {
  return { type: 'line', ...kUnseen, showSymbol: false, data: [from, to], lineStyle: { color: p.faint, width: 1, type: [4, 3] }, z: 1, ...more };
}

/** A step function: each value holds until the next point's x. */
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
export function pathSeries(name: string, points: readonly (readonly [number, number])[], style: { colour: string; width: number; dash?: unknown; opacity?: number }, more: Option = kUnseen, of?: unknown): Option {
  return {
    name, type: 'custom', clip: true, data: points.length === 0 ? [] : [{ value: points[0], of }], encode: { x: 0, y: 1 }, itemStyle: { color: style.colour }, z: 4,
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
    type: 'custom', clip: true, ...kUnseen, data: outline.length === 0 ? [] : [[...(outline[0] ?? [0, 0])]], encode: { x: 0, y: 1 },
    renderItem: (_: unknown, api: CustomApi) => ({ type: 'polygon', shape: { points: outline.map(([x, y]) => api.coord([x, y])) }, style: { fill: colour, opacity } }),
  };
}

/** Height of a label beside a curve [px]. */
const kLabel = 15;
/** Between the last mark and the labels [px]. */
const kBeside = 9;

/** Names right of the ends of curves, in so much `room` [px], moved apart where they would overlap; `ends` at [x, y] in data. */
function endLabels(ends: readonly { name: string; at: readonly [number, number]; colour: string }[], room: number): Option {
  return {
    type: 'custom', clip: false, ...kUnseen, z: 6, data: ends.slice(0, 1).map((e) => [...e.at]), encode: { x: 0, y: 1 },
    renderItem: (_: unknown, api: CustomApi) => {
      const placed = ends.map((e) => { const [x = 0, y = 0] = api.coord([...e.at]); return { e, x, y, at: y }; }).sort((a, b) => a.y - b.y);
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
  };
}

/** The axis of a gain, with the values that were tried as its marks; over a decade and more it is logarithmic. `at` places a value. */
export function gainAxis(p: Palette, values: readonly number[], width: number): { at: (v: number) => number; option: Option } {
  const levels = [...new Set(values)].sort((a, b) => a - b);
  const [low = 0, high = 0] = [levels[0], levels[levels.length - 1]];
  const log = low > 0 && high / low >= 10;
  const at = (v: number): number => (log ? Math.log10(v) : v);
  const room = Math.max(2, Math.floor(width / 46));
  // Many values show the ends and some between.
  const marks = levels.length <= room ? levels : [...new Set(Array.from({ length: room }, (_, i) => levels[Math.round((i * (levels.length - 1)) / (room - 1))] ?? low))];
  const edge = high > low ? 0.06 * (at(high) - at(low)) : Math.abs(at(low)) || 1;
  const custom = { customValues: marks.map(at) };
  return {
    at,
    option: axis(p, '', {
      min: at(low) - edge, max: at(high) + edge, splitLine: { show: false }, axisTick: { show: true, lineStyle: { color: p.faint }, ...custom },
      axisLabel: custom,
    }, (v) => plain(Number((log ? 10 ** v : v).toPrecision(3)))),
  };
}

/** Room on the right of plots side by side for half of the last number below them [px]. */
const kRight = 28;

/** Layout of plots side by side [px]: room on the left for the common axis, least width of a plot, most plots in a row, height. */
const kLayout = { left: 58, narrowest: 200, most: 4, high: 118 };

/**
 * A plot for each part under its title, all with the same y axis and, unless `xAxis` gives each its own, the same x axis;
 * `series` gives what each shows.
 */
export function smallMultiples(width: number, parts: readonly { title: string; colour: string }[], xAxis: Option | ((place: number) => Option), yAxis: Option, series: (place: number) => Option[], tooltip: Option, { left, narrowest, most, high } = kLayout): { height: number; option: Option } {
  const columns = Math.max(1, Math.min(most, parts.length, Math.floor((width - left) / narrowest)));
  const rows = Math.ceil(parts.length / columns);
  const [above, gap, between] = [30, 28, 22];
  const wide = Math.max(80, Math.min(420, (width - left - kRight - (columns - 1) * between) / columns));
  const grid = parts.map((_, i) => ({
    left: left + (i % columns) * (wide + between), width: wide, top: above + Math.floor(i / columns) * (high + above + gap), height: high, outerBoundsMode: 'none',
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

/** Groups of marks that share their axes. */
interface Plots {
  groups: readonly { short: string; mark: number }[];
  /** Marks of more groups hide each other: each group is then drawn in a plot of its own. */
  most: number;
  /** The axis along x of a plot with about so many marks. */
  x: (marks: number) => Option;
  y: Option;
  /** The series of a group; `alone`: in a plot of its own. */
  series: (place: number, alone: boolean) => Option[];
  /** Drawn once behind all groups of one plot. */
  behind?: Option[];
  tooltip: Option;
  /** End of a group's curve, where its name stands. Without an end, or without room, names stand above the plot. */
  end?: (place: number) => readonly [number, number];
  height?: number;
}

export function plots(p: Palette, width: number, { groups, most, x, y, series, behind = [], tooltip, end, height = 380 }: Plots): { height: number; option: Option } {
  if (groups.length > most) {
    return smallMultiples(width, groups.map((g) => ({ title: g.short, colour: seriesInk(p, g.mark) })), x(3), y, (place) => series(place, true), tooltip);
  }
  const names = groups.map((g) => g.short);
  const wanted = 26 + 7.4 * Math.max(...names.map((name) => name.length));
  const beside = end !== undefined && wanted <= 0.36 * width;
  const above = beside ? 0 : legendHeight(names, width);
  return {
    height: height + (end === undefined ? 0 : above),
    option: {
      ...(beside ? {} : { legend: legend(p, names) }), grid: gridBox(above + (end === undefined ? 4 : 14), beside ? wanted : 26, 8),
      xAxis: x(marksIn(width)), yAxis: y, tooltip,
      series: [...behind, ...groups.flatMap((_, i) => series(i, false)),
        ...(beside ? [endLabels(groups.map((g, i) => ({ name: g.short, at: end(i), colour: seriesInk(p, g.mark) })), wanted)] : [])],
    },
  };
}
