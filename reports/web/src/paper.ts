// Figures on white paper: as SVG to be saved, and in the page itself while it is printed.

import * as echarts from 'echarts/core';

import { base, kFont, textOf, type FigureSpec } from './chart';
import { h, replace } from './dom';
import { drawAll } from './draw_order';
import { palette, usePaper } from './theme';

/** Advance widths of DejaVu Sans, by size of the font: the widest of the fonts that stand in for a missing one. */
const kWide: readonly (readonly [letters: RegExp, width: number])[] = [
  [/[ijl|'.,:;! \u00a0\u202f\u00b7]/, 0.35], [/[frt()[\]/"-]/, 0.42], [/[mMwW@%\u2026\u2212\u00b1\u00d7\u2192]/, 1], [/[A-Z_]/, 0.78], [/[\u0020-\u024f\u2010-\u2027]/, 0.64],
];

function width(text: string, font: string): number {
  const size = Number(/([\d.]+)px/.exec(font)?.[1] ?? 12);
  const bold = /\b(bold|[6-9]00)\b/.test(font) ? 1.1 : 1;
  let sum = 0;
  for (const letter of text) sum += kWide.find(([letters]) => letters.test(letter))?.[1] ?? 1;
  return sum * size * bold;
}

/** A canvas measures in the page's own font; a saved figure is shown in whatever fonts its reader has. */
function measured<T>(draw: () => T): T {
  const canvas = typeof document === 'undefined' ? null : document.createElement('canvas').getContext('2d');
  echarts.setPlatformAPI({ measureText: (text, font) => ({ width: width(text ?? '', font ?? '') }) as TextMetrics });
  try {
    return draw();
  } finally {
    if (canvas !== null) {
      echarts.setPlatformAPI({
        measureText: (text, font) => {
          canvas.font = font ?? '12px sans-serif';
          return canvas.measureText(text ?? '');
        },
      });
    }
  }
}

const kWidth = 760;

/** White around a saved figure, for letters of wider fonts; and the height of its title [px]. */
const kMargin = 14;
const kTitle = 30;

/** `svg` of so many pixels with white around it and a title above. */
function titled(svg: string, title: string, wide: number, tall: number): string {
  const text = title.replace(/[&<>]/g, (letter) => `&#${letter.charCodeAt(0)};`);
  const [w, h] = [wide + 2 * kMargin, tall + 2 * kMargin + kTitle];
  const inner = svg.replace(/^<svg[^>]*>/, '').replace(/<\/svg>\s*$/, '');
  return `<svg width="${w}" height="${h}" xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink" version="1.1" viewBox="0 0 ${w} ${h}">`
    + `<title>${text}</title><rect width="${w}" height="${h}" fill="#ffffff"/>`
    + `<text x="${kMargin}" y="${kMargin + 14}" fill="${palette(true).ink}" style="font-size:15px;font-family:${kFont};font-weight:600;">${text}</text>`
    + `<g transform="translate(${kMargin} ${kMargin + kTitle})">${inner}</g></svg>`;
}

/** The figure on white paper, with its title and a margin unless it is `bare`; null where it has nothing to show. Needs no browser. */
export function svgOf(spec: FigureSpec, bare = false): string | null {
  const drawing = spec.draw(palette(true), kWidth);
  if (drawing === null) return null;
  const { option, height = 340 } = drawing;
  return measured(() => {
    const paper = echarts.init(null, null, { renderer: 'svg', ssr: true, width: kWidth, height });
    paper.setOption({ ...base(palette(true)), ...option, animation: false, backgroundColor: '#ffffff' });
    const svg = paper.renderToSVGString();
    paper.dispose();
    return bare ? svg : titled(svg, textOf(spec.title), kWidth, height);
  });
}

const stills: { place: HTMLElement; make: () => Node | null }[] = [];

/** A place that shows in print what `make` gives, which is called for each print. */
export function onPaper(make: () => Node | null): HTMLElement {
  const place = h('div', { class: 'on-paper', 'aria-hidden': 'true' });
  stills.push({ place, make });
  return place;
}

export function paperFigure(spec: FigureSpec): Node | null {
  const svg = svgOf(spec, true);
  if (svg === null) return null;
  const element = new DOMParser().parseFromString(svg, 'image/svg+xml').documentElement;
  element.setAttribute('width', '100%');
  element.removeAttribute('height');
  return document.importNode(element, true);
}

/** Before the page is printed: light colours, and all that waits is drawn, as lines instead of pixels. */
export function startPaper(): void {
  addEventListener('beforeprint', () => {
    usePaper(true);
    drawAll();
    for (const { place, make } of stills) replace(place, make());
  });
  addEventListener('afterprint', () => {
    for (const { place } of stills) replace(place);
    usePaper(false);
  });
}
