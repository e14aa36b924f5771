// What the tests of paper share: prints are read back from the PDF; saved figures go through a parser of XML and a renderer that
// is not the page's.
import { execFileSync } from 'node:child_process';
import { mkdirSync, readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';

import { check, kPython, near, saved } from './kit.mjs';

export const run = (program, ...args) => execFileSync(program, args, { maxBuffer: 1 << 28 });

/** Pages of a PDF as pixels: width, height, rgb. Of all pages, or of one. */
export const pixelsOf = (pdf, dpi, page = 0) => {
  const ppm = run('pdftoppm', '-r', String(dpi), ...(page > 0 ? ['-f', String(page), '-l', String(page)] : []), pdf);
  const pages = [];
  for (let at = 0; at < ppm.length;) {
    const head = /^P6\s+(\d+)\s+(\d+)\s+255\s/.exec(ppm.subarray(at, at + 40).toString('latin1'));
    const [width, height] = [Number(head[1]), Number(head[2])];
    at += head[0].length;
    pages.push({ width, height, rgb: ppm.subarray(at, at + 3 * width * height) });
    at += 3 * width * height;
  }
  return pages;
};

/** The text of each page of a PDF. */
export const textsOf = (pdf) => run('pdftotext', '-layout', pdf, '-').toString().split('\f').slice(0, -1);

/** Every figure of a page whose figures are drawn, saved into `folder`: SVG that is XML, drawn by librsvg within its borders. */
export const figuresAreSaved = async (page, folder, what) => {
  mkdirSync(folder);
  const svgs = [];
  for (const figure of await page.locator('.figure').all()) {
    const button = figure.getByText('Save SVG');
    if (!await button.isVisible()) continue;
    svgs.push(join(folder, `${(await figure.getAttribute('id')).replace('figure-', '')}.svg`));
    writeFileSync(svgs.at(-1), await saved(page, button));
  }
  check(svgs.length >= 7, `${what}: ${svgs.length} figures`);
  // Each program once for all figures of a page.
  const noXml = run(kPython, '-c', 'import sys, xml.dom.minidom\nfor name in sys.argv[1:]:\n  try: xml.dom.minidom.parse(name)\n  except Exception as e: print(name, e)', ...svgs).toString();
  check(noXml === '', `${what}: not XML: ${noXml}`);
  if (noXml !== '') return;
  const pdf = join(folder, 'librsvg.pdf');
  run('rsvg-convert', '-f', 'pdf', '-o', pdf, ...svgs);
  const images = pixelsOf(pdf, 72);
  check(images.length === svgs.length, `${what}: librsvg draws ${images.length} of ${svgs.length} figures`);
  images.forEach((image, i) => {
    let [ink, border] = [0, 0];
    for (let y = 0; y < image.height; ++y) {
      for (let x = 0; x < image.width; ++x) {
        const k = 3 * (y * image.width + x);
        if (image.rgb[k] > 235 && image.rgb[k + 1] > 235 && image.rgb[k + 2] > 235) continue;
        ink += 1;
        if (x < 1 || y < 1 || x >= image.width - 1 || y >= image.height - 1) border += 1;
      }
    }
    check(ink > 300, `${what}: ${svgs[i]} shows something (${ink} pixels)`);
    check(border === 0, `${what}: ${svgs[i]} is cut off at its border (${border} pixels)`);
  });
};

/** The paired plot is square, and worlds in which one has no value are spread over its strips. */
export const pairedIsSquare = (file) => {
  const svg = readFileSync(file, 'utf8');
  const [, x0, y0, x1, y1] = (/<path d="M([\d.]+) ([\d.]+)L([\d.]+) ([\d.]+)"[^>]*stroke-dasharray/.exec(svg) ?? []).map(Number);
  check(near(x1 - x0, y0 - y1, 0.2) && x1 - x0 > 150, `equal values lie on a line at 45 degrees: from ${x0}, ${y0} to ${x1}, ${y1}`);
  const dots = [...svg.matchAll(/transform="matrix\([\d.]+,0,0,[\d.]+,([\d.]+),([\d.]+)\)" fill="#(?!e3e0d8)/g)].map((m) => [Number(m[1]), Number(m[2])]);
  const strip = dots.filter(([x, y]) => x < x0 - 1 || y > y0 + 1);
  const across = strip.map(([x, y]) => (x < x0 - 1 ? x : y));
  check(strip.length > 8 && new Set(across.map((v) => v.toFixed(1))).size > 0.8 * strip.length, `${strip.length} of ${dots.length} dots lie in the strips, at ${new Set(across.map((v) => v.toFixed(1))).size} places across`);
};
