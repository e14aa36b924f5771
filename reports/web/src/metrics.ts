// The metrics a trial may have: how the page names them and writes them.

import { fixed, significant } from './format';

export interface Metric {
  key: string;
  name: string;
  unit: string;
  /** '' where neither end is better by itself. */
  better: 'high' | 'low' | '';
  of: 'trial' | 'world' | 'machine';
  /** Its name as a head of the table of trials; '' is not listed there. */
  head: string;
  /** Its column in the table of results, where it has one. */
  summary: { column: string; name: string } | undefined;
  /** Of the suite's own. */
  own: boolean;
  write: (value: number) => string;
}

/** A metric as the page's data describes it: the description of the store's columns. */
export interface MetricData {
  key: string; name: string; unit: string; better: Metric['better']; text: string;
  /** Whose figure it is: the trial's, the world's (its difficulty), or the machine's (timings). */
  of: Metric['of'];
  /** How it is written: with so many decimals, or else so many significant digits. */
  decimals?: number; significant?: number;
  head?: string; summary?: { column: string; name: string }; own?: boolean;
}

function made({ key, of, name, unit, better, decimals, significant: digits, head = '', summary, own }: MetricData): Metric {
  const write = decimals === undefined
    ? (value: number): string => significant(value, digits ?? 3)
    : (value: number): string => fixed(value, decimals);
  return { key, of, name, unit, better, head, summary, own: own === true, write };
}

/** All metrics that a trial may have, in the order of their description. */
export let kMetrics: readonly Metric[] = [];
let byKey = new Map<string, Metric>();

export function describeMetrics(data: readonly MetricData[]): void {
  kMetrics = data.map(made);
  byKey = new Map(kMetrics.map((of) => [of.key, of]));
}

export function metric(key: string): Metric {
  return byKey.get(key) ?? made({ key, of: 'trial', name: key, unit: '', better: '', text: '' });
}

/** "time to goal [s]", for axes and table heads. */
export function axisName(of: Metric): string {
  return of.unit === '' ? of.name : `${of.name} [${of.unit}]`;
}

export function withUnit(of: Metric, value: number): string {
  return of.unit === '' || !Number.isFinite(value) ? of.write(value) : `${of.write(value)}\u00a0${of.unit}`;
}
