// The selected trial: the table shows it, figures mark it, and the replay plays it if the page has its motion.

import type { Model } from './data';
import * as state from './state';

const listeners: ((trial: string, play: boolean) => void)[] = [];

/** Called when a trial is chosen; `play` asks for its motion to be brought into view. */
export function onSelect(call: (trial: string, play: boolean) => void): void {
  listeners.push(call);
}

/** The row of the chosen trial, which figures of trials mark; undefined where none is chosen. */
export function chosenRow(model: Model): number | undefined {
  return model.row(state.get('trial'));
}

export function select(trial: string, play: boolean): void {
  state.set({ trial }, play);
  for (const call of listeners) call(trial, play);
}
