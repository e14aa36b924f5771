// The metrics a trial may have: how the page names them and writes them.

import { fixed, significant } from './format';

/** A metric as the page's data describes it: the description of the store's columns. */
export interface MetricData {
  key: string; name: string; unit: string; text: string;
  /** '' where neither end is better by itself. */
  better: 'high' | 'low' | '';
  /** Whose figure it is: the trial's, the world's (its difficulty), or the machine's (timings). */
  of: 'trial' | 'world' | 'machine';
  /** How it is written: with so many decimals, or else so many significant digits. */
  decimals?: number; significant?: number;
  /** Head of its column in the table of trials; without one it has no column. */
  head?: string;
  /** Column of the table of results, if it has one. */
  summary?: { column: string; name: string };
  /** True for a metric that a suite defines. */
  own?: boolean;
}

export interface Metric extends MetricData { write: (value: number) => string }

function made(data: MetricData): Metric {
  const { decimals, significant: digits } = data;
  return { ...data, write: (value) => (decimals === undefined ? significant(value, digits ?? 3) : fixed(value, decimals)) };
}

/** All metrics that a trial may have, in the order of their description. */
export let kMetrics: readonly Metric[] = [];

export function describeMetrics(data: readonly MetricData[]): void {
  kMetrics = data.map(made);
}

export function metric(key: string): Metric {
  return kMetrics.find((of) => of.key === key) ?? made({ key, of: 'trial', name: key, unit: '', better: '', text: '' });
}

/** "time to goal [s]", for axes and table heads. */
export function axisName(of: Metric): string {
  return of.unit === '' ? of.name : `${of.name} [${of.unit}]`;
}

export function withUnit(of: Metric, value: number): string {
  return of.unit === '' || !Number.isFinite(value) ? of.write(value) : `${of.write(value)}\u00a0${of.unit}`;
}
