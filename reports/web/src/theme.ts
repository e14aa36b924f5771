// Colours of data, for light and dark. Series differ in mark and dash as well as in hue.

import { readable } from './colour';
import type { Outcome } from './data';
import { tell } from './state';

export interface Palette {
  dark: boolean;
  ink: string; muted: string; faint: string; rule: string; surface: string;
  series: readonly string[];
  outcomes: Readonly<Record<Outcome, string>>;
  /** Steps from the least to the greatest value of a map of colours. */
  ramp: readonly string[];
  scene: Readonly<Record<'background' | 'floor' | 'grid' | 'base' | 'arm' | 'object' | 'moving' | 'hit' | 'goal' | 'path' | 'begin' | 'ghost' | 'wheel' | 'plan' | 'occupied' | 'unseen' | 'fields', string>>;
}

/** How many series have a colour of their own. */
export const kColours = 8;

// Within series and within outcomes any two can be told apart, by people who see no red or no green too; a test simulates it.
const light: Palette = {
  dark: false, ink: '#20262f', muted: '#5a6472', faint: '#6b7480', rule: '#e3e0d8', surface: '#ffffff',
  series: ['#27598f', '#d96294', '#016155', '#d57e24', '#1d5ccb', '#3f8440', '#029edb', '#4a3518'],
  outcomes: {
    success: '#4c9a7d', collision: '#8d1020', timeout: '#fca347', stuck: '#3a1acf', joint_limit: '#5c57b9',
    tipped: '#77325a', infeasible: '#76b8f1', diverged: '#6e75a0', spilled: '#b5651d', error: '#020b24',
  },
  ramp: ['#f3f1ea', '#c9dbe2', '#86b3c9', '#41799f', '#173d63'],
  scene: {
    background: '#eeece6', floor: '#f4f2ed', grid: '#d8d4c9', base: '#5d6b7e', arm: '#f7f8fa', object: '#b5ab9b', moving: '#cfae74', hit: '#c4472f', goal: '#c79a2b',
    path: '#27598f', begin: '#9db4cc', ghost: '#b8447b', wheel: '#3a424d', plan: '#1f8a78', occupied: '#6a4fb3', unseen: '#5f6a75', fields: '#1f86c0',
  },
};

const dark: Palette = {
  dark: true, ink: '#e9e7e2', muted: '#aab1bc', faint: '#8b93a0', rule: '#2d333d', surface: '#1a1e25',
  series: ['#7fb0e6', '#cb64a3', '#9ed4a6', '#ebb22a', '#6791f8', '#c9e67a', '#deeaf3', '#cd7a4f'],
  outcomes: {
    success: '#56ad8d', collision: '#b83c10', timeout: '#e4c86a', stuck: '#3750c3', joint_limit: '#817f4c',
    tipped: '#98487c', infeasible: '#b1d9ec', diverged: '#7896c6', spilled: '#5a2d0c', error: '#dff4d4',
  },
  ramp: ['#1d2733', '#24496b', '#3b7fae', '#7fc0d8', '#e8f3e2'],
  scene: {
    background: '#171b21', floor: '#1b2027', grid: '#2c343f', base: '#8794a6', arm: '#d7dde6', object: '#6b6257', moving: '#8a7450', hit: '#e2664c', goal: '#dcb45a',
    path: '#7fb0e6', begin: '#5d6570', ghost: '#cb64a3', wheel: '#4a525e', plan: '#4fb3a0', occupied: '#9a86e0', unseen: '#8d98a5', fields: '#4aa8dc',
  },
};

const kSymbols = ['circle', 'diamond', 'triangle', 'rect', 'roundRect', 'pin', 'arrow', 'circle'] as const;
export const kDashes = ['solid', [6, 3], [2, 3], [9, 3, 2, 3], [12, 4], [1, 2], [4, 2, 1, 2], [8, 2]] as const;

const system = (): MediaQueryList => matchMedia('(prefers-color-scheme: dark)');
let chosen: 'light' | 'dark' | null = null;
let paper = false;

export function isDark(): boolean {
  if (paper) return false;
  return chosen === null ? system().matches : chosen === 'dark';
}

/** Both, for tests. */
export const kPalettes: readonly Palette[] = [light, dark];

/** Returns the palette that the page shows now, or that of paper for a saved figure. */
export function palette(saved = false): Palette {
  return !saved && isDark() ? dark : light;
}

export function seriesColour(of: Palette, mark: number): string {
  return mark < 0 ? of.faint : of.series[mark % of.series.length] ?? of.ink;
}

/** An outcome without a colour, as in a newer store, has the faintest. */
export function outcomeColour(of: Palette, outcome: Outcome): string {
  return of.outcomes[outcome] ?? of.faint;
}

/** The series' colour where it is a text's. */
export function seriesInk(of: Palette, mark: number): string {
  return readable(seriesColour(of, mark), of.ink, of.surface);
}

/** When the colours repeat, dash and symbol differ from the first round. */
function again(mark: number, kinds: number): number {
  return (mark + Math.floor(mark / kColours)) % kinds;
}

export function dashOf(mark: number): (typeof kDashes)[number] {
  return kDashes[again(mark, kDashes.length)] ?? 'solid';
}

export function symbolOf(mark: number): (typeof kSymbols)[number] {
  return kSymbols[again(mark, kSymbols.length)] ?? 'circle';
}

function apply(): void {
  document.documentElement.dataset['theme'] = isDark() ? 'dark' : 'light';
  tell(new Set(['theme']));
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

/** While the page is printed it is light, whatever the reader has chosen. */
export function usePaper(on: boolean): void {
  const was = isDark();
  paper = on;
  if (isDark() !== was) apply();
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
