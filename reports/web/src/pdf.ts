// A figure's SVG as a PDF page of its size, lines and text kept as such. Node only.

import PDFDocument from 'pdfkit';
import draw from 'svg-to-pdfkit';
import regular from '@fontsource/inter/files/inter-latin-400-normal.woff';
import bold from '@fontsource/inter/files/inter-latin-600-normal.woff';

/** A pixel of the page is 1/96 inch. */
const kPoints = 0.75;

/** The same bytes for the same figure. */
export function pdfOf(svg: string): Promise<Uint8Array> {
  const [, width = '760', height = '340'] = /<svg width="([\d.]+)" height="([\d.]+)"/.exec(svg) ?? [];
  const size: [number, number] = [Number(width) * kPoints, Number(height) * kPoints];
  return new Promise((done, fail) => {
    // Without a font of its own, pdfkit would look for one on the disk.
    const page = new PDFDocument({ size, margin: 0, font: regular as unknown as string, info: { Producer: 'moma', Creator: 'moma', CreationDate: new Date(0) } });
    const parts: Uint8Array[] = [];
    page.on('data', (part: Uint8Array) => parts.push(part));
    page.on('error', fail);
    page.on('end', () => done(Buffer.concat(parts)));
    page.registerFont('regular', regular as unknown as string);
    page.registerFont('bold', bold as unknown as string);
    draw(page, svg, 0, 0, {
      width: size[0], height: size[1], assumePt: false,
      fontCallback: (_family: string, isBold: boolean) => (isBold ? 'bold' : 'regular'),
    });
    page.end();
  });
}
