// What figures.ts uses of node; its whole types would replace the browser's.
declare module 'node:fs' {
  export function readFileSync(path: string, encoding: 'utf8'): string;
  export function writeFileSync(path: string, content: string | Uint8Array): void;
}
declare module 'node:path' {
  export function join(...parts: string[]): string;
}
declare const Buffer: { concat(parts: readonly Uint8Array[]): Uint8Array };
declare const process: { argv: string[] };
