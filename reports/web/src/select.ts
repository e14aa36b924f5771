// A trial that was chosen anywhere: it is shown in the table, marked in figures, and played where its motion is in the page.

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
