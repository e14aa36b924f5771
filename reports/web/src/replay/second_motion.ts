// Which motion plays beside the one that is shown: another controller's in the same world, as chosen.

import { outcomeName, type Model } from '../data';
import { h, replace } from '../dom';
import * as state from '../state';

/** So many are offered. */
const kMost = 40;

export class SecondMotion {
  private readonly list = h('select', { 'aria-label': 'Beside it', change: () => state.set({ beside: this.list.value }) });
  readonly element = h('label', { class: 'choice', hidden: true }, h('span', null, 'beside it'), this.list);

  constructor(private readonly model: Model) {}

  /** Trials of other controllers in the world of `trial` that can be played, successes first. */
  private rivals(trial: string): string[] {
    const t = this.model.trials;
    const row = this.model.row(trial);
    if (row === undefined) return [];
    const same = (name: string, i: number): boolean => t.text(name, i) === t.text(name, row);
    const found: number[] = [];
    for (let i = 0; i < t.n; ++i) {
      if (i !== row && same('world_key', i) && same('suite', i) && same('robot', i) && same('mode', i) && this.model.playable(t.text('trial', i))) found.push(i);
    }
    return found.sort((a, b) => Number(t.success(b)) - Number(t.success(a))).slice(0, kMost).map((i) => t.text('trial', i));
  }

  /** The trial to play beside `current`, as chosen; '' for none. */
  wanted(current: string, all = this.rivals(current)): string {
    const chosen = state.get('beside');
    return all.includes(chosen) ? chosen : '';
  }

  /** Offers what can play beside `current`. */
  fill(current: string): void {
    const t = this.model.trials;
    const all = this.rivals(current);
    this.element.hidden = all.length === 0;
    const now = this.wanted(current, all);
    replace(this.list, h('option', { value: '', selected: now === '' }, 'nothing'), ...all.map((trial) => {
      const row = this.model.row(trial) ?? -1;
      return h('option', { value: trial, selected: trial === now }, `${t.text('controller', row)}${t.text('point', row) === '' ? '' : ` ${t.text('point', row)}`}: ${outcomeName(t.outcome(row))}`);
    }));
  }
}
