// A replay's samples: base64, deflated, bytes put back in order, columns of float32.

import type { ReplayData } from '../data';
import { columnsOf } from '../packed';

export class Trace {
  readonly n: number;
  readonly end: number;
  private readonly columns = new Map<string, Float32Array>();
  readonly t: Float32Array;

  constructor(source: ReplayData, values: Float32Array) {
    this.n = source.n;
    source.columns.forEach((name, i) => this.columns.set(name, values.subarray(i * source.n, (i + 1) * source.n)));
    this.t = this.column('t');
    this.end = this.t[this.n - 1] ?? 0;
  }

  names(): string[] {
    return [...this.columns.keys()];
  }

  has(name: string): boolean {
    return this.columns.has(name);
  }

  column(name: string): Float32Array {
    const found = this.columns.get(name);
    if (found === undefined) throw new Error(`the samples have no ${name}`);
    return found;
  }

  /** Index of the sample at or before t, and how far it is to the next (0 to 1). */
  locate(t: number): [number, number] {
    let low = 0;
    let high = this.n - 1;
    while (low < high) {
      const middle = (low + high + 1) >> 1;
      // A slider rounds: its value may lie a hair before the sample that it was set to.
      if ((this.t[middle] ?? 0) <= t + 1e-6) low = middle;
      else high = middle - 1;
    }
    if (low + 1 >= this.n) return [this.n - 1, 0];
    const span = (this.t[low + 1] ?? 0) - (this.t[low] ?? 0);
    return [low, span > 0 ? Math.min(1, Math.max(0, (t - (this.t[low] ?? 0)) / span)) : 0];
  }

  /** Linear between samples. */
  at(name: string, t: number): number {
    const column = this.column(name);
    const [i, s] = this.locate(t);
    const a = column[i] ?? 0;
    return s === 0 ? a : a + s * ((column[i + 1] ?? a) - a);
  }
}

/** Throws an Error where the samples do not fit their columns. */
export function decode(source: ReplayData): Trace {
  return new Trace(source, columnsOf(source.data, source.n, source.columns.length, 'the samples'));
}
