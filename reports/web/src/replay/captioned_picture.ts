// A frame to take along: the scene with what the page writes over it, drawn into one picture.

import { kFont } from '../chart';
import type { Palette } from '../theme';

export interface Words {
  outcome: string; colour: string;   // of the chip
  caption: string;
  clock: string;
  labels: readonly { x: number; y: number; text: string; active: boolean }[];   // middles, in CSS pixels of the scene
}

/** Words in lines no wider than `room` tells. */
function wrapped(text: string, width: (line: string) => number, room: (line: number) => number): string[] {
  const lines: string[] = [];
  let line = '';
  for (const word of text.split(' ')) {
    const longer = line === '' ? word : `${line} ${word}`;
    if (line !== '' && width(longer) > room(lines.length)) {
      lines.push(line);
      line = word;
    } else {
      line = longer;
    }
  }
  return [...lines, line];
}

/** Draws onto `canvas` the scene, which must just have been rendered, and the words. Sides are even, as encoders of video want them. */
export function drawCaptioned(canvas: HTMLCanvasElement, scene: HTMLCanvasElement, p: Palette, { outcome, colour, caption, clock, labels }: Words): void {
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
  const across = scene.clientWidth;
  const begin = (line: number): number => (line === 0 ? 2.4 * size + wide : 1.7 * size);
  const lines = wrapped(caption, (line) => c.measureText(line).width, (line) => across - begin(line) - size);
  lines.forEach((line, k) => halo(line, begin(k), (2 + 1.5 * k) * size, p.ink));
  const top = (2 + 1.5 * lines.length) * size;
  for (const label of labels) {
    const half = c.measureText(label.text).width / 2;
    halo(label.text, Math.max(4, Math.min(across - 4 - 2 * half, label.x - half)), Math.max(top, Math.min(scene.clientHeight - 3 * size, label.y)), label.active ? p.scene.hit : p.muted);
  }
  halo(clock, scene.clientWidth - size - c.measureText(clock).width, scene.clientHeight - 1.3 * size, p.ink);
}
