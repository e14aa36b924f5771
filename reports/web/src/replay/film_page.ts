// The page of `moma replay --video`: the scene alone, as large as the film, driven frame by frame from outside.

import type { FilmSize, Model } from '../data';
import { h, replace } from '../dom';
import { player } from './player';

declare global {
  interface Window {
    /** What reports/render/video.cc calls. */
    momaFilm?: { begin(): Promise<number>; add(k: number): Promise<void>; end(): Promise<string> };
  }
}

/** In pieces: a call cannot have as many arguments as a film has bytes. */
function base64(bytes: Uint8Array): string {
  let text = '';
  for (let i = 0; i < bytes.length; i += 0x8000) text += String.fromCharCode(...bytes.subarray(i, i + 0x8000));
  return btoa(text);
}

export function startFilm(app: HTMLElement, model: Model, { width, height, fps, speed }: FilmSize): void {
  const { element, reel } = player(model);
  const made = reel?.(fps, speed);
  if (made === undefined) throw new Error('there is no motion to film');
  document.documentElement.classList.add('filming');
  replace(app, h('div', { style: `--width:${width}px;--height:${height}px` }, element));
  window.momaFilm = { begin: () => made.begin(), add: (k) => made.add(k), end: async () => base64(await made.end()) };
}
