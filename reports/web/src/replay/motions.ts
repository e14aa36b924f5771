// Which motions are played: the list of trials to choose from, and another controller's motion in the same world beside it.

import { outcomeName, type Model } from '../data';
import { dotted, h, replace, roving } from '../dom';
import { integer, plural } from '../format';
import { select } from '../select';
import * as state from '../state';
import { outcomeColour, palette } from '../theme';

/** Trials to choose from: the worst of each kind with samples; where none has any but all can be asked for, failures. */
export function listed(model: Model): string[] {
  const named = model.page.replays.map((replay) => replay.trial);
  const t = model.trials;
  if (named.length > 0 || model.page.live?.simulates !== true) return named;
  const rows = t.rows();
  const failed = rows.filter((row) => !t.success(row));
  return (failed.length > 0 ? failed : rows).slice(0, 24).map((row) => t.text('trial', row));
}

/** Names the source of the motions in a sentence. */
export function motionsNote(model: Model): string {
  const [first] = model.page.replays;
  if (model.page.live !== undefined) {
    return model.page.samples_stored === 0 ? 'Any trial can be played, from the table too: it is simulated again.'
      : `The worst of each kind, of ${plural(model.page.samples_stored, 'trial')} with stored samples. Any other can be played from the table${model.page.live.simulates ? ': it is simulated again' : ''}.`;
  }
  const won = new Set(model.page.replays.map(({ trial }) => model.trials.success(model.row(trial) ?? -1)));
  return `${plural(model.page.replays.length, 'trial')} at ${first !== undefined && 'hz' in first ? first.hz : 10} Hz: the worst of each kind first, of ${integer(model.page.samples_stored)} with stored samples${won.size === 2 ? ', and successes to play beside failures' : ''}.`;
}

export class MotionList {
  readonly element = roving(h('div', { class: 'shelf', role: 'listbox', 'aria-label': 'Trials that can be played' }), 'button');

  constructor(private readonly model: Model) {}

  /** Lists the trials anew, with the one that is shown. */
  fill(current: string): void {
    const t = this.model.trials;
    const p = palette();
    const names = listed(this.model);
    replace(this.element, ...(current === '' || names.includes(current) ? names : [current, ...names]).map((trial) => {
      const row = this.model.row(trial) ?? 0;
      return h('button', {
        type: 'button', role: 'option', 'aria-selected': trial === current ? 'true' : 'false', click: () => select(trial, true),
      },
        dotted(outcomeColour(p, t.outcome(row)), outcomeName(t.outcome(row))),
        h('small', null, `${t.text('controller', row)} \u00b7 ${t.text('family', row)} ${integer(t.number('world', row))}`),
        t.text('point', row) === '' ? null : h('small', null, t.text('point', row)),
        t.text('link', row) === '' ? null : h('small', null, `${t.text('link', row)} \u2013 ${t.text('object', row)}`));
    }));
  }
}

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
    return t.rows().filter((i) => i !== row && ['world_key', 'suite', 'robot', 'mode'].every((name) => same(name, i)) && this.model.playable(t.text('trial', i)))
      .sort((a, b) => Number(t.success(b)) - Number(t.success(a))).slice(0, kMost).map((i) => t.text('trial', i));
  }

  /** The trial to play beside `current`, as chosen; '' for none. */
  wanted(current: string, all = this.rivals(current)): string {
    const chosen = state.get('beside');
    return all.includes(chosen) ? chosen : '';
  }

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
