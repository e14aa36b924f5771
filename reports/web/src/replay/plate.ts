// A frame to take along: the scene with what the page writes over it, drawn into one picture.

import { kFont } from '../chart';
import type { Palette } from '../theme';

export interface Words {
  outcome: string; colour: string;   // of the chip
  caption: string;
  clock: string;
  labels: readonly { x: number; y: number; text: string; active: boolean }[];   // in CSS pixels of the scene
}

export class Plate {
  readonly canvas = document.createElement('canvas');

  /** Draws the scene, which must just have been rendered, and the words. Sides are even, as encoders of video want them. */
  draw(scene: HTMLCanvasElement, p: Palette, hit: string, { outcome, colour, caption, clock, labels }: Words): void {
    const { canvas } = this;
    const [width, height] = [scene.width & ~1, scene.height & ~1];
    if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
    const c = canvas.getContext('2d');
    if (c === null) return;
    const scale = scene.width / Math.max(1, scene.clientWidth);
    c.setTransform(1, 0, 0, 1, 0, 0);
    c.drawImage(scene, 0, 0);
    c.setTransform(scale, 0, 0, scale, 0, 0);
    const size = Math.max(13, Math.round(scene.clientWidth / 70));
    c.textBaseline = 'middle';
    const halo = (text: string, x: number, y: number, ink: string): void => {
      c.lineJoin = 'round';
      c.lineWidth = size / 3;
      c.strokeStyle = p.dark ? 'rgba(23,27,33,0.8)' : 'rgba(255,255,255,0.85)';
      c.strokeText(text, x, y);
      c.fillStyle = ink;
      c.fillText(text, x, y);
    };
    c.font = `600 ${size}px ${kFont}`;
    const wide = c.measureText(outcome).width;
    c.fillStyle = colour;
    c.fillRect(size, 1.55 * size, 0.35 * size, 0.9 * size);
    halo(outcome, 1.7 * size, 2 * size, p.ink);
    c.font = `${size}px ${kFont}`;
    halo(caption, 2.4 * size + wide, 2 * size, p.ink);
    for (const label of labels) halo(label.text, label.x - c.measureText(label.text).width / 2, label.y, label.active ? hit : p.muted);
    c.font = `${size}px ${kFont}`;
    halo(clock, scene.clientWidth - size - c.measureText(clock).width, scene.clientHeight - 1.3 * size, p.ink);
  }
}
