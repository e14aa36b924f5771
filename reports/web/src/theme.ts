// Colours of data, for light and dark. Series differ in mark and dash as well as in hue.

import type { Outcome } from './data';

export interface Palette {
  dark: boolean;
  ink: string;
  muted: string;
  faint: string;
  rule: string;
  surface: string;
  series: readonly string[];
  outcomes: Record<Outcome, string>;
}

/** How many series have a colour of their own. */
export const kColours = 8;

const light: Palette = {
  dark: false, ink: '#20262f', muted: '#5a6472', faint: '#8b94a1', rule: '#e3e0d8', surface: '#ffffff',
  series: ['#27598f', '#b23a76', '#1b8578', '#a77a12', '#6a55b5', '#5c6b2f', '#4aa0c4', '#7a4a32'],
  outcomes: {
    success: '#4c9a7d', collision: '#c4472f', timeout: '#e0ae4a', stuck: '#a9793f', joint_limit: '#8170b8',
    tipped: '#b5608f', infeasible: '#6d8db0', diverged: '#555c68', error: '#1d222a',
  },
};

const dark: Palette = {
  dark: true, ink: '#e9e7e2', muted: '#aab1bc', faint: '#7d8592', rule: '#2d333d', surface: '#1a1e25',
  series: ['#7fb0e6', '#ea86b8', '#55c4b3', '#dcb45a', '#ab9cec', '#a9bd6b', '#8fd2ee', '#cf9a7c'],
  outcomes: {
    success: '#56ad8d', collision: '#e2664c', timeout: '#e6b95c', stuck: '#bb8d55', joint_limit: '#9c8bd6',
    tipped: '#cf7dab', infeasible: '#86a7cc', diverged: '#828a97', error: '#d5d8dd',
  },
};

const kSymbols = ['circle', 'diamond', 'triangle', 'rect', 'roundRect', 'pin', 'arrow', 'circle'] as const;
export const kDashes = ['solid', [6, 3], [2, 3], [9, 3, 2, 3], [12, 4], [1, 2], [4, 2, 1, 2], [8, 2]] as const;

const system = (): MediaQueryList => matchMedia('(prefers-color-scheme: dark)');
let chosen: 'light' | 'dark' | null = null;
const listeners: (() => void)[] = [];

export function isDark(): boolean {
  return chosen === null ? system().matches : chosen === 'dark';
}

/** Of the page now; of paper (`paper`) for saved figures. */
export function palette(paper = false): Palette {
  return !paper && isDark() ? dark : light;
}

export function seriesColour(of: Palette, mark: number): string {
  return mark < 0 ? of.faint : of.series[mark % of.series.length] ?? of.ink;
}

/** Where colours come round again, dash and symbol are others than the first time. */
function again(mark: number, kinds: number): number {
  return (mark + Math.floor(mark / kColours)) % kinds;
}

export function dashOf(mark: number): (typeof kDashes)[number] {
  return kDashes[again(mark, kDashes.length)] ?? 'solid';
}

export function symbolOf(mark: number): (typeof kSymbols)[number] {
  return kSymbols[again(mark, kSymbols.length)] ?? 'circle';
}

export function onTheme(call: () => void): void {
  listeners.push(call);
}

function apply(): void {
  document.documentElement.dataset['theme'] = isDark() ? 'dark' : 'light';
  for (const call of listeners) call();
}

export function toggleTheme(): void {
  chosen = isDark() ? 'light' : 'dark';
  try {
    localStorage.setItem('moma-theme', chosen);
  } catch {
    // A page opened from a file may have no storage; the choice then lasts as long as the page.
  }
  apply();
}

export function startTheme(): void {
  try {
    const kept = localStorage.getItem('moma-theme');
    if (kept === 'light' || kept === 'dark') chosen = kept;
  } catch {
    chosen = null;
  }
  system().addEventListener('change', apply);
  apply();
}
