// One figure: its frame, the chart (ECharts), its data as CSV, itself as SVG on white paper.

import { BarChart, BoxplotChart, CustomChart, HeatmapChart, LineChart, ScatterChart } from 'echarts/charts';
import {
  AriaComponent, GridComponent, LegendComponent, TooltipComponent, VisualMapComponent,
} from 'echarts/components';
import * as echarts from 'echarts/core';
import { CanvasRenderer, SVGRenderer } from 'echarts/renderers';

import { download, h, replace } from './dom';
import { csv } from './format';
import { onTheme, palette, type Palette } from './theme';
import { onView } from './view';

echarts.use([
  BarChart, BoxplotChart, CustomChart, HeatmapChart, LineChart, ScatterChart, AriaComponent, GridComponent,
  LegendComponent, TooltipComponent, VisualMapComponent, CanvasRenderer, SVGRenderer,
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
  title: string;
  /** One sentence on how to read it. */
  caption: string;
  controls?: (redraw: () => void) => Node[];
  /** null: there is nothing to show, and `empty` says why. */
  draw: (palette: Palette, width: number) => Drawing | null;
  empty: string;
  /** What must be read before the first drawing. */
  prepare?: () => Promise<void>;
  /** A mark was clicked; `data` is its datum, undefined for a line. */
  click?: (data: unknown, mark: { seriesIndex: number; dataIndex: number }) => void;
}

export const kFont = '"Inter Variable", "Inter", system-ui, "Segoe UI", sans-serif';

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

/** Round limits around [low, high] and the step between about `count` marks. */
export function nice(low: number, high: number, count = 6): { min: number; max: number; interval: number } {
  const span = high > low ? high - low : Math.abs(high) || 1;
  const rough = span / count;
  const power = 10 ** Math.floor(Math.log10(rough));
  const interval = ([1, 2, 2.5, 5, 10].find((s) => s * power >= rough) ?? 10) * power;
  return { min: Math.floor(low / interval + 1e-9) * interval, max: Math.ceil(high / interval - 1e-9) * interval || interval, interval };
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

/** What is so near to the window is drawn [px]. */
const kMargin = 300;

const waiting = new Map<Element, () => void>();
let observer: IntersectionObserver | null = null;

/** Made when first needed: figures are also drawn where there is no window. */
function seen(): IntersectionObserver {
  return observer ??= new IntersectionObserver((entries, self) => {
    for (const entry of entries) {
      if (!entry.isIntersecting) continue;
      self.unobserve(entry.target);
      waiting.get(entry.target)?.();
      waiting.delete(entry.target);
    }
  }, { rootMargin: `${kMargin}px` });
}

/** Calls back once, when the element comes near the window. */
export function whenSeen(element: Element, call: () => void): void {
  waiting.set(element, call);
  seen().observe(element);
}

/** As far outside the window as whenSeen() looks. */
export function isNear(element: Element): boolean {
  const box = element.getBoundingClientRect();
  return box.bottom > -kMargin && box.top < innerHeight + kMargin;
}

/** What is drawn when nothing else is to do, and for paper. */
const figures: Element[] = [];

function drawWaiting(element: Element): void {
  const call = waiting.get(element);
  if (call === undefined) return;
  seen().unobserve(element);
  waiting.delete(element);
  call();
}

let idling = 0;

/** Draws the figures that nobody has looked at yet, one at a time, when the reader has done nothing for a while. */
function drawSoon(): void {
  const idle = (): void => {
    const next = figures.find((element) => waiting.has(element));
    if (next === undefined) return;
    drawWaiting(next);
    requestIdleCallback(idle);
  };
  clearTimeout(idling);
  idling = window.setTimeout(() => requestIdleCallback(idle), 1500);
}

/** Draws all figures sooner or later, and for paper all at once. */
export function drawWhenIdle(): void {
  drawSoon();
  addEventListener('beforeprint', () => figures.forEach(drawWaiting));
}

/** An element like a figure: first drawn when it is seen, or nothing else is to do. */
export function drawLater(element: Element, draw: () => void): void {
  figures.push(element);
  whenSeen(element, draw);
}

/** Draws now where the element is near the window, else when it comes there or nothing else is to do. */
export function drawOrWait(element: Element, draw: () => void): void {
  if (isNear(element)) {
    waiting.delete(element);
    draw();
    return;
  }
  whenSeen(element, draw);
  drawSoon();
}

/** The figure on white paper; null where it has nothing to show. Needs no browser. */
export function svgOf(spec: FigureSpec): string | null {
  const width = 760;
  const drawing = spec.draw(palette(true), width);
  if (drawing === null) return null;
  const paper = echarts.init(null, null, { renderer: 'svg', ssr: true, width, height: drawing.height ?? 340 });
  paper.setOption({ ...base(palette(true)), ...drawing.option, animation: false, backgroundColor: '#ffffff' });
  const svg = paper.renderToSVGString();
  paper.dispose();
  return svg;
}

export function figure(spec: FigureSpec): HTMLElement {
  const plot = h('div', { class: 'plot', role: 'img', 'aria-label': spec.title });
  const note = h('p', { class: 'note' });
  const saveSvg = h('button', { type: 'button', class: 'quiet', click: () => save() }, 'Save SVG');
  const saveCsv = h('button', { type: 'button', class: 'quiet', click: () => saveData() }, 'Data CSV');
  const controls = h('div', { class: 'controls' });
  const element = h('figure', { class: 'figure', id: `figure-${spec.id}` },
    h('figcaption', null, h('div', null, h('h3', null, spec.title), h('p', null, spec.caption)), controls),
    plot, h('footer', null, note, h('div', { class: 'actions' }, saveSvg, saveCsv)));
  let chart: echarts.ECharts | null = null;
  let started = false;
  let height = 0;

  const draw = (): void => {
    if (!started) return;
    const drawing = spec.draw(palette(), plot.clientWidth);
    saveSvg.hidden = saveCsv.hidden = drawing === null;
    if (drawing === null) {
      chart?.dispose();
      chart = null;
      height = 0;
      plot.style.height = 'auto';
      plot.style.minHeight = '0';
      replace(plot, h('p', { class: 'empty' }, spec.empty));
      note.textContent = '';
      return;
    }
    const wanted = drawing.height ?? 340;
    if (chart === null) replace(plot);
    if (wanted !== height) {
      height = wanted;
      plot.style.height = `${wanted}px`;
      plot.style.minHeight = '0';   // no longer the place kept for it
      chart?.resize();
    }
    if (chart === null) {
      chart = echarts.init(plot, null, { renderer: 'canvas' });
      chart.on('click', (event) => spec.click?.(event.data, { seriesIndex: event.seriesIndex ?? -1, dataIndex: event.dataIndex }));
    }
    const series = (drawing.option['series'] as Option[]).map((s) => (spec.click === undefined ? { cursor: 'default', ...s } : s));
    chart.setOption({ ...base(palette()), ...drawing.option, series }, { notMerge: true });
    note.textContent = drawing.note;
    plot.setAttribute('aria-label', `${spec.title}. ${drawing.note}`);
  };

  const save = (): void => {
    const svg = svgOf(spec);
    if (svg !== null) download(`${spec.id}.svg`, 'image/svg+xml', svg);
  };

  const saveData = (): void => {
    const drawing = spec.draw(palette(), 760);
    if (drawing !== null) download(`${spec.id}.csv`, 'text/csv', csv(drawing.columns, drawing.rows));
  };

  const fillControls = (): void => replace(controls, ...(spec.controls?.(() => { fillControls(); draw(); }) ?? []));
  drawLater(element, () => {
    started = true;
    fillControls();
    if (spec.prepare === undefined) draw();
    else void spec.prepare().then(draw);
    let width = plot.clientWidth;
    new ResizeObserver(() => {
      if (plot.clientWidth === width) return;
      width = plot.clientWidth;
      chart?.resize();
      draw();
    }).observe(plot);
  });
  const redraw = (): void => {
    if (started) drawOrWait(element, () => { fillControls(); draw(); });
  };
  onView(redraw);
  onTheme(redraw);
  return element;
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

