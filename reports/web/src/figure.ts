// One figure: its frame, the chart (ECharts), its data as CSV, itself as SVG on white paper.

import * as echarts from 'echarts/core';

import { base, textOf, type FigureSpec, type Option } from './chart';
import { button, choice, download, h, replace } from './dom';
import { fillLater, footer, saveCsv } from './panel';
import { onPaper, paperFigure, svgOf } from './paper';
import * as state from './state';
import { palette } from './theme';
import { naming } from './view';

export function figure(spec: FigureSpec): HTMLElement {
  const plot = h('div', { class: 'plot', role: 'img', 'aria-label': textOf(spec.title) });
  const title = h('h3', null, textOf(spec.title));
  const caption = h('p', null, textOf(spec.caption));
  const note = h('p', { class: 'note' });
  const svgButton = button('Save SVG', () => {
    const svg = svgOf(spec);
    if (svg !== null) download(`${spec.id}.svg`, new Blob([svg], { type: 'image/svg+xml' }));
  });
  const csvButton = saveCsv(spec.id, () => spec.draw(palette(), 760));
  const controls = h('div', { class: 'controls' });
  const element = h('figure', { class: 'figure', id: `figure-${spec.id}` },
    h('figcaption', null, h('div', null, title, caption), controls),
    plot, onPaper(() => paperFigure(spec)), footer(note, svgButton, csvButton));
  let chart: echarts.ECharts | null = null;
  let width = 0;   // of the plot when it was drawn

  const draw = (): void => {
    replace(controls, ...(spec.choices ?? []).map(({ key, label, options, value }) => {
      const all = options();
      return all.length < 2 ? null : choice(label, all, value?.() ?? state.get(key), (chosen) => {
        state.set({ [key]: chosen });
        draw();
      });
    }));
    title.textContent = textOf(spec.title);
    caption.textContent = textOf(spec.caption);
    width = plot.clientWidth;   // asked for once: after changes to the page each answer is a layout
    const drawing = spec.draw(palette(), width);
    svgButton.hidden = csvButton.hidden = drawing === null;
    if (drawing === null) {
      chart?.dispose();
      chart = null;
      plot.style.height = 'auto';
      plot.style.minHeight = '0';
      replace(plot, h('p', { class: 'empty' }, spec.empty));
      note.textContent = '';
      return;
    }
    const height = drawing.height ?? 340;
    plot.style.height = `${height}px`;
    plot.style.minHeight = '0';   // no longer the place kept for it
    if (chart === null) {
      replace(plot);
      chart = echarts.init(plot, null, { renderer: 'canvas', width, height });
      chart.on('click', ({ data }) => {
        const of = (data as { of?: unknown } | undefined)?.of;
        if (of !== undefined) spec.click?.(of);
      });
    } else if (chart.getWidth() !== width || chart.getHeight() !== height) {
      chart.getZr().resize({ width, height });   // the chart's own resize() would draw what is about to be replaced
    }
    const series = (drawing.option['series'] as Option[]).map((s) => (spec.click === undefined ? { cursor: 'default', ...s } : s));
    // No animation if the system prefers reduced motion.
    const still = matchMedia('(prefers-reduced-motion: reduce)').matches ? { animation: false } : {};
    const common = base(palette());
    const tooltip = { ...common['tooltip'] as Option, ...drawing.option['tooltip'] as Option | undefined };
    chart.setOption({ ...common, ...drawing.option, tooltip, ...still, series }, { notMerge: true });
    note.textContent = drawing.note + naming();
    plot.setAttribute('aria-label', `${textOf(spec.title)}. ${drawing.note}`);
  };

  fillLater(element, draw, ...(spec.linked === true ? ['trial'] : []));
  new ResizeObserver(() => { if (width > 0 && plot.clientWidth !== width) draw(); }).observe(plot);
  return element;
}
