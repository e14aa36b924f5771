// Signals of the controller under one time line: errors, manipulability, distance, slack, any other signal of the samples, solver status.

import { kFont } from '../chart';
import { kWords } from '../data';
import { significant } from '../format';
import { extent } from '../stats';
import { outcomeColour, type Palette } from '../theme';
import type { Trace } from './trace';

interface Track { name: string; column: string; unit: string; colour: (p: Palette) => string; limit?: 'position' | 'rotation' }

const kTracks: readonly Track[] = [
  { name: 'position error', column: 'error_position', unit: 'm', colour: (p) => p.series[0] ?? p.ink, limit: 'position' },
  { name: 'rotation error', column: 'error_rotation', unit: 'rad', colour: (p) => p.series[4] ?? p.ink, limit: 'rotation' },
  { name: 'manipulability', column: 'manipulability', unit: '', colour: (p) => p.series[2] ?? p.ink },
  { name: 'least distance', column: 'least_distance', unit: 'm', colour: (p) => p.series[3] ?? p.ink },
  { name: 'slack', column: 'slack', unit: '', colour: (p) => p.series[1] ?? p.ink },
];

const kRow = 40;
const kStrip = 22;
const leftIn = (width: number): number => (width < 520 ? 104 : 150);

export function statusAt(trace: Trace, t: number): string {
  const [i] = trace.locate(t);
  const word = (column: string): string => (kWords[column]?.[trace.column(column)[i] ?? 0] ?? 'unknown').replaceAll('_', ' ');
  return word('fallback') === 'none' ? word('status') : `${word('status')}; fallback: ${word('fallback')}`;
}

/** Tolerance of arrival [m, rad]. */
interface Tolerances { position: number; rotation: number }

/** Columns of a motion's samples that may be added to the time line, with their names: those of joints have the joint's. */
export function signals(trace: Trace, joints: readonly string[]): [column: string, name: string][] {
  const base = trace.names().filter((name) => /^command\d+$/.test(name)).length - joints.length;
  const shown = new Set(['t', ...kTracks.map((track) => track.column)]);
  return trace.names().filter((name) => !shown.has(name)).map((name) => {
    const [, stem = '', place = ''] = /^(q|qdot|command)(\d+)$/.exec(name) ?? [];
    const joint = joints[Number(place) - (stem === 'q' ? 0 : base)];
    return [name, stem === '' ? name.replaceAll('_', ' ') : `${stem} ${joint ?? `base ${place}`}`];
  });
}

export class Timeline {
  /** A column that the reader has added, with its name; null: none. */
  signal: { column: string; name: string } | null = null;
  private trace: Trace | null = null;
  /** Another motion on the same clock, drawn pale. */
  ghost: Trace | null = null;
  private tolerances: Tolerances | null = null;

  constructor(private readonly canvas: HTMLCanvasElement, seek: (t: number) => void) {
    const at = (event: PointerEvent): void => {
      if (this.trace === null) return;
      const box = canvas.getBoundingClientRect();
      const left = leftIn(box.width);
      seek(Math.min(1, Math.max(0, (event.clientX - box.left - left) / (box.width - left - 8))) * this.end);
    };
    canvas.addEventListener('pointerdown', (event) => { canvas.setPointerCapture(event.pointerId); at(event); });
    canvas.addEventListener('pointermove', (event) => { if (event.buttons > 0) at(event); });
  }

  show(trace: Trace, tolerances: Tolerances | null): void {
    this.trace = trace;
    this.tolerances = tolerances;
    this.ghost = null;
  }

  get end(): number {
    return Math.max(this.trace?.end ?? 0, this.ghost?.end ?? 0);
  }

  draw(p: Palette, t: number): void {
    const { canvas, trace } = this;
    const width = canvas.clientWidth;
    const tracks: Track[] = [...kTracks, ...(this.signal === null || !trace?.has(this.signal.column) ? [] : [{ ...this.signal, unit: '', colour: (of: Palette): string => of.series[5] ?? of.ink }])];
    const height = tracks.length * kRow + kStrip + 24;
    const ratio = Math.min(devicePixelRatio, 2);
    if (width === 0 || trace === null) return;
    canvas.width = Math.round(width * ratio);
    canvas.height = Math.round(height * ratio);
    canvas.style.height = `${height}px`;
    const c = canvas.getContext('2d');
    if (c === null) return;
    c.scale(ratio, ratio);
    const left = leftIn(width);
    const wide = width - left - 8;
    const end = this.end;
    const x = (time: number): number => left + (end > 0 ? time / end : 0) * wide;
    c.textBaseline = 'middle';
    const write = (text: string, at: number, y: number, colour: string, font = '12px'): void => {
      Object.assign(c, { font: `${font} ${kFont}`, fillStyle: colour });
      c.fillText(text, at, y);
    };
    /** A line through points, broken where one has no height. */
    const line = (points: Iterable<readonly [number, number]>, colour: string, lineWidth: number, dash: number[] = []): void => {
      Object.assign(c, { strokeStyle: colour, lineWidth });
      c.setLineDash(dash);
      c.beginPath();
      let down = false;
      for (const [at, height_] of points) {
        const seen = Number.isFinite(height_);
        if (seen && down) c.lineTo(at, height_);
        else if (seen) c.moveTo(at, height_);
        down = seen;
      }
      c.stroke();
    };
    tracks.forEach((track, row) => {
      const top = row * kRow;
      const both = [trace, this.ghost].filter((of): of is Trace => of?.has(track.column) === true);
      const [low, most] = extent([0, ...both.flatMap((of) => [...of.column(track.column)])]) ?? [0, 0];
      const limit = track.limit === undefined ? undefined : this.tolerances?.[track.limit];
      const y = (value: number): number => top + kRow - 5 - (most > low ? (value - low) / (most - low) : 0) * (kRow - 10);
      const level = (at: number, colour: string, dash?: number[]): void => line([[left, at], [left + wide, at]], colour, 1, dash);
      const curve = (of: Trace): [number, number][] => [...of.column(track.column)].map((value, i) => [x(of.t[i] ?? 0), y(value)]);
      level(y(0) + 0.5, p.rule);
      if (limit !== undefined && limit < most) level(y(limit), outcomeColour(p, 'success'), [4, 3]);   // arrived below this
      if (this.ghost !== null && both.includes(this.ghost)) line(curve(this.ghost), p.muted, 1, [2, 2]);
      line(curve(trace), track.colour(p), 1.5);
      write(track.name, 0, top + 13, p.muted);
      const now = trace.at(track.column, Math.min(t, trace.end));
      write(Number.isFinite(now) ? `${significant(now)} ${track.unit}` : 'none near', 0, top + 29, p.ink, '600 12px');
    });
    const top = tracks.length * kRow + 6;
    const status = trace.column('status');
    const fallback = trace.column('fallback');
    for (let i = 0; i < trace.n; ++i) {
      const bad = (status[i] ?? 0) !== 0 || (fallback[i] ?? 0) !== 0;
      c.fillStyle = !bad ? outcomeColour(p, 'success') : kWords['fallback']?.[fallback[i] ?? 0] === 'brake' ? outcomeColour(p, 'collision') : outcomeColour(p, 'timeout');
      c.globalAlpha = bad ? 1 : 0.45;
      const from = x(trace.t[i] ?? 0);
      c.fillRect(from, top, Math.max(1.2, x(i + 1 < trace.n ? trace.t[i + 1] ?? 0 : trace.end) - from + 0.3), 9);
    }
    c.globalAlpha = 1;
    write('solver', 0, top + 5, p.muted);
    const step = [0.5, 1, 2, 5, 10].find((s) => end / s <= (width < 520 ? 5 : 10)) ?? 10;
    for (let mark = 0; mark <= end; mark += step) write(`${mark}${mark === 0 ? ' s' : ''}`, x(mark), top + 22, p.faint, '11px');
    line([[x(t), 0], [x(t), top + 12]], p.ink, 1);
  }
}
