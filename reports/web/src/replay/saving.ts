// What can be taken along: a moment of a motion as PNG, the motion as WebM.

import { downloadBlob, h } from '../dom';
import { fixed, integer } from '../format';
import type { Film } from './film';

/** Frames a second of a motion that is saved. */
const kFps = 30;

/** Whether this browser encodes video. */
function canFilm(): boolean {
  return typeof VideoEncoder !== 'undefined';
}

/** What encodes is a large part of the script, and run only where something is filmed. */
async function newFilm(canvas: HTMLCanvasElement, fps: number): Promise<Film> {
  const { Film } = await import('./film');
  return new Film(canvas, fps);
}

/** A motion that is shown. */
export interface Shown {
  /** Of the trial; another one's is another. '' while nothing is shown. */
  name(): string;
  /** [s] */
  time(): number;
  /** [s] */
  end(): number;
  /** Seconds of the motion per second of the film. */
  rate(): number;
  seek(t: number): void;
  /** Stops what plays by itself. */
  pause(): void;
  /** The moment shown, with its words. */
  picture(): HTMLCanvasElement;
}

async function addFrame(of: Shown, film: Film, t: number): Promise<void> {
  of.seek(t);
  of.picture();
  await film.add();
}

export function pictureButton(of: Shown): HTMLButtonElement {
  const save = (): void => {
    if (of.name() !== '') of.picture().toBlob((blob) => { if (blob !== null) downloadBlob(`${of.name()}-${fixed(of.time(), 2)}s.png`, blob); });
  };
  return h('button', { type: 'button', class: 'quiet', click: save }, 'Save PNG');
}

/** Records the motion from its begin to its end at the chosen speed; a second click stops that. */
export function filmButton(of: Shown): HTMLButtonElement {
  let filming: symbol | null = null;
  const save = async (): Promise<void> => {
    if (of.name() === '' || filming !== null) {
      filming = null;
      return;
    }
    if (!canFilm()) {
      button.textContent = 'No WebM here';
      return;
    }
    const [name, from, rate] = [of.name(), of.time(), of.rate()];
    of.pause();
    const mine = filming = Symbol(name);
    const wanted = (): boolean => filming === mine && of.name() === name;
    const frames = Math.ceil((of.end() * kFps) / rate) + 1;
    try {
      const film = await newFilm(of.picture(), kFps);
      await film.begin();
      for (let k = 0; k < frames && wanted(); ++k) {
        await addFrame(of, film, (k * rate) / kFps);
        button.textContent = `Stop at ${integer(Math.round((100 * k) / frames))} %`;
      }
      if (wanted()) downloadBlob(`${name}.webm`, new Blob([await film.end() as BlobPart], { type: 'video/webm' }));
      else await film.cancel();
      button.textContent = 'Save WebM';
    } catch {
      button.textContent = 'No WebM here';
    }
    if (filming === mine) filming = null;
    if (of.name() === name) of.seek(from);
  };
  const button = h('button', { type: 'button', class: 'quiet', click: () => void save() }, 'Save WebM');
  return button;
}
