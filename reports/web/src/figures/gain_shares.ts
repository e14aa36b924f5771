// How much of the difference between a sweep's points each gain explains by itself.

import type { FigureSpec } from '../chart';
import type { Model } from '../data';
import { effects } from '../effects';
import { integer, plural } from '../format';
import { view } from '../view';
import { shareBars } from './share_bars';
import { gains, measure, measureChoice, points, short, type Measure, type Point } from './swept';

/** The measure of each point in each world that all points met and have it in: a row per point. */
function byWorld(model: Model, all: readonly Point[], of: Measure): number[][] {
  const t = model.trials;
  const value = 'outcome' in of.trial ? ((outcome) => (row: number): number => Number(t.outcome(row) === outcome))(of.trial.outcome) : ((key) => (row: number): number => t.number(key, row))(of.trial.metric);
  const series = view().model.series(view().slice, view().family);
  const maps = all.map((point) => {
    const rows = series.find((s) => s.controller === point.controller && s.point === point.point)?.rows ?? [];
    return new Map(rows.map((row) => [t.text('world_key', row), value(row)]));
  });
  const worlds = [...(maps[0]?.keys() ?? [])].filter((world) => maps.every((map) => Number.isFinite(map.get(world) ?? NaN)));
  return maps.map((map) => worlds.map((world) => map.get(world) ?? NaN));
}

export function gainShares(model: Model): FigureSpec {
  return {
    id: 'shares',
    title: () => `How much of the ${measure().name} each gain explains`,
    caption: 'Share of what points differ by that a gain accounts for by itself, chance taken off; bars are one standard error.',
    empty: 'Nothing can be told: all combinations of the gains\u2019 values must have run on the same worlds, and differ by more than chance.',
    controls: (redraw) => [measureChoice(redraw)],
    draw: (p, width) => {
      const of = measure();
      const all = points(model);
      const keys = gains(all);
      if (keys.length === 0 || new Set(all.map((point) => point.controller)).size > 1) return null;
      const values = byWorld(model, all, of);
      const found = effects(all.map((point) => keys.map((key) => point.values.get(key) ?? NaN)), values);
      if (found === null) return null;
      const worlds = values[0]?.length ?? 0;
      const { shares, errors } = found;
      return shareBars(p, width, keys.map((key, i) => ({ name: short(key), key, share: Math.min(1, Math.max(0, shares[i] ?? 0)), error: errors?.[i] ?? null })),
        `n = ${plural(worlds, 'world')} that all ${integer(all.length)} points met${'metric' in of.trial ? ' and have the measure in; means, not medians' : ''}. Analysis of variance over points and worlds${errors === null ? '; too few worlds for errors' : '; errors: jackknife over twentieths of the worlds'}. What is left of 100 % is what gains do together.`);
    },
  };
}
