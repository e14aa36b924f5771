// Files to save: a moment of a motion as PNG, the motion as WebM.

import { button, download } from '../dom';
import { fixed, integer } from '../format';
import type { Playback } from './playback';

/** Frames a second of a motion that is saved. */
const kFps = 30;

/** A motion that is shown. */
export interface Shown {
  /** Name of the shown trial, distinct for each; '' while nothing is shown. */
  name(): string;
  playback: Playback;
  /** The moment shown, with its words. */
  picture(): HTMLCanvasElement;
}

export function pictureButton(of: Shown): HTMLButtonElement {
  const save = (): void => {
    if (of.name() !== '') of.picture().toBlob((blob) => { if (blob !== null) download(`${of.name()}-${fixed(of.playback.time, 2)}s.png`, blob); });
  };
  return button('Save PNG', save);
}

/** Records the motion from its begin to its end at the chosen speed; a second click stops that. */
export function filmButton(of: Shown): HTMLButtonElement {
  let filming: symbol | null = null;
  const save = async (): Promise<void> => {
    if (of.name() === '' || filming !== null) {
      filming = null;
      return;
    }
    const { playback } = of;
    const [name, from, rate] = [of.name(), playback.time, playback.rate];
    playback.pause();
    const mine = filming = Symbol(name);
    const frames = Math.ceil((playback.end() * kFps) / rate) + 1;
    const drawFrame = (k: number): void => {
      playback.seek((k * rate) / kFps);
      of.picture();
      made.textContent = `Stop at ${integer(Math.round((100 * k) / frames))} %`;
    };
    try {
      // The encoder is a large part of the script; it starts with the first film.
      const { film } = await import('./film');
      const video = await film(of.picture(), frames, kFps, drawFrame, () => filming === mine && of.name() === name);
      if (video !== null) download(`${name}.webm`, video);
      made.textContent = 'Save WebM';
    } catch {
      made.textContent = 'No WebM here';   // a browser that encodes no video
    }
    if (filming === mine) filming = null;
    if (of.name() === name) playback.seek(from);
  };
  const made = button('Save WebM', () => void save());
  return made;
}
