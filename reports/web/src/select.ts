// A trial that was chosen anywhere: it is shown in the table, and played where its motion is in the page.

import * as state from './state';

const listeners: ((trial: string, play: boolean) => void)[] = [];

/** Called when a trial is chosen; `play` asks for its motion to be brought into view. */
export function onSelect(call: (trial: string, play: boolean) => void): void {
  listeners.push(call);
}

export function select(trial: string, play: boolean): void {
  state.set({ trial }, play);
  for (const call of listeners) call(trial, play);
}
