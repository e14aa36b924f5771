// What the controller knew and did, under one time line: errors, manipulability, distance, slack, solver status.

import { significant } from '../format';
import { kFont } from '../chart';
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
const kLeft = 150;

const kStatus = ['solved', 'infeasible', 'iteration limit', 'invalid input'];
const kFallback = ['', 'without acceleration bounds', 'relaxed rows', 'braked'];

export function timelineHeight(): number {
  return kTracks.length * kRow + kStrip + 24;
}

/** In words: what the solver did at time t. */
export function statusAt(trace: Trace, t: number): string {
  const [i] = trace.locate(t);
  const status = kStatus[trace.column('status')[i] ?? 0] ?? 'unknown';
  const fallback = kFallback[trace.column('fallback')[i] ?? 0] ?? '';
  return fallback === '' ? status : `${status}, ${fallback}`;
}

/** What counts as arrived [m, rad]. */
export interface Tolerances { position: number; rotation: number }

export class Timeline {
  private trace: Trace | null = null;
  private ghost: Trace | null = null;
  private tolerances: Tolerances | null = null;

  constructor(private readonly canvas: HTMLCanvasElement, seek: (t: number) => void) {
    const at = (event: PointerEvent): void => {
      if (this.trace === null) return;
      const box = canvas.getBoundingClientRect();
      const left = this.left(box.width);
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

  /** Another motion on the same clock, drawn pale; null takes it away. */
  beside(ghost: Trace | null): void {
    this.ghost = ghost;
  }

  /** Of the longer motion [s]. */
  get end(): number {
    return Math.max(this.trace?.end ?? 0, this.ghost?.end ?? 0);
  }

  private left(width: number): number {
    return width < 520 ? 104 : kLeft;
  }

  draw(p: Palette, t: number): void {
    const { canvas, trace } = this;
    const width = canvas.clientWidth;
    const height = timelineHeight();
    const ratio = Math.min(devicePixelRatio, 2);
    if (width === 0 || trace === null) return;
    canvas.width = Math.round(width * ratio);
    canvas.height = Math.round(height * ratio);
    canvas.style.height = `${height}px`;
    const c = canvas.getContext('2d');
    if (c === null) return;
    c.scale(ratio, ratio);
    const left = this.left(width);
    const wide = width - left - 8;
    const end = this.end;
    const x = (time: number): number => left + (end > 0 ? time / end : 0) * wide;
    c.textBaseline = 'middle';
    kTracks.forEach((track, row) => {
      const top = row * kRow;
      let most = 0;
      for (const of of [trace, this.ghost]) for (const value of of?.column(track.column) ?? []) if (Number.isFinite(value)) most = Math.max(most, value);
      const limit = track.limit === undefined ? undefined : this.tolerances?.[track.limit];
      const y = (value: number): number => top + kRow - 5 - (most > 0 ? Math.max(0, value) / most : 0) * (kRow - 10);
      c.strokeStyle = p.rule;
      c.lineWidth = 1;
      c.beginPath();
      c.moveTo(left, top + kRow - 4.5);
      c.lineTo(left + wide, top + kRow - 4.5);
      c.stroke();
      if (limit !== undefined && most > 0 && limit < most) {   // arrived below this
        c.strokeStyle = outcomeColour(p, 'success');
        c.setLineDash([4, 3]);
        c.beginPath();
        c.moveTo(left, y(limit));
        c.lineTo(left + wide, y(limit));
        c.stroke();
        c.setLineDash([]);
      }
      const curve = (of: Trace): void => {
        const column = of.column(track.column);
        c.beginPath();
        let down = false;
        for (let i = 0; i < of.n; ++i) {
          const value = column[i] ?? NaN;
          if (!Number.isFinite(value)) {
            down = false;
            continue;
          }
          if (down) c.lineTo(x(of.t[i] ?? 0), y(value));
          else c.moveTo(x(of.t[i] ?? 0), y(value));
          down = true;
        }
        c.stroke();
      };
      if (this.ghost !== null) {
        c.strokeStyle = p.muted;
        c.lineWidth = 1;
        c.setLineDash([2, 2]);
        curve(this.ghost);
        c.setLineDash([]);
      }
      c.strokeStyle = track.colour(p);
      c.lineWidth = 1.5;
      curve(trace);
      c.font = `12px ${kFont}`;
      c.fillStyle = p.muted;
      c.fillText(track.name, 0, top + 13);
      const now = trace.at(track.column, Math.min(t, trace.end));
      c.font = `600 12px ${kFont}`;
      c.fillStyle = p.ink;
      c.fillText(Number.isFinite(now) ? `${significant(now)} ${track.unit}` : 'none near', 0, top + 29);
    });
    const top = kTracks.length * kRow + 6;
    const status = trace.column('status');
    const fallback = trace.column('fallback');
    for (let i = 0; i < trace.n; ++i) {
      const bad = (status[i] ?? 0) !== 0 || (fallback[i] ?? 0) !== 0;
      c.fillStyle = !bad ? outcomeColour(p, 'success') : (fallback[i] ?? 0) === 3 ? outcomeColour(p, 'collision') : outcomeColour(p, 'timeout');
      c.globalAlpha = bad ? 1 : 0.45;
      const from = x(trace.t[i] ?? 0);
      c.fillRect(from, top, Math.max(1.2, x(i + 1 < trace.n ? trace.t[i + 1] ?? 0 : trace.end) - from + 0.3), 9);
    }
    c.globalAlpha = 1;
    c.font = `12px ${kFont}`;
    c.fillStyle = p.muted;
    c.fillText('solver', 0, top + 5);
    c.fillStyle = p.faint;
    c.font = `11px ${kFont}`;
    const step = [0.5, 1, 2, 5, 10].find((s) => end / s <= (width < 520 ? 5 : 10)) ?? 10;
    for (let mark = 0; mark <= end; mark += step) c.fillText(`${mark}${mark === 0 ? ' s' : ''}`, x(mark), top + 22);
    c.strokeStyle = p.ink;
    c.lineWidth = 1;
    c.beginPath();
    c.moveTo(x(t), 0);
    c.lineTo(x(t), top + 12);
    c.stroke();
  }
}
