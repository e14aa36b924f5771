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

// The part of node that figures.ts uses; its whole types would replace the browser's.
declare module 'node:fs' {
  export function readFileSync(path: string, encoding: 'utf8'): string;
  export function writeFileSync(path: string, content: string | Uint8Array): void;
}
declare module 'node:path' {
  export function join(...parts: string[]): string;
}
declare const Buffer: { concat(parts: readonly Uint8Array[]): Uint8Array };
declare const process: { argv: string[] };

declare module '*.css';
