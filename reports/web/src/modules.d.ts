declare module '*.woff' {
  const bytes: Uint8Array;
  export default bytes;
}

/** What we use of pdfkit and svg-to-pdfkit, which come without types. */
declare module 'pdfkit' {
  interface Options { size: [number, number]; margin: number; font: string; info: Record<string, string | Date> }
  export default class PDFDocument {
    constructor(options: Options);
    on(event: 'data', call: (part: Uint8Array) => void): void;
    on(event: 'error', call: (error: Error) => void): void;
    on(event: 'end', call: () => void): void;
    registerFont(name: string, bytes: string): void;
    end(): void;
  }
}

declare module 'svg-to-pdfkit' {
  import type PDFDocument from 'pdfkit';
  interface Options { width: number; height: number; assumePt: boolean; fontCallback: (family: string, bold: boolean) => string }
  export default function draw(page: PDFDocument, svg: string, x: number, y: number, options: Options): void;
}
