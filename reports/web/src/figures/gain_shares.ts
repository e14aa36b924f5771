// Share of each gain in the difference between a sweep's points, as bars with their errors.

import { axis, gridBox, nice, plain, rowAxis, tip, tipOf, whiskers, type Drawing, type FigureSpec } from '../chart';
import { effects } from '../gain_effects';
import { integer, percent, plural } from '../format';
import { seriesColour, type Palette } from '../theme';
import { view } from '../view';
import { gains, kMeasureChoice, measure, points, short, type Measure, type Point } from './swept';

/** `error`: one standard error; null where there is none. */
export interface Share { name: string; key: string; share: number; error: number | null }

export function shareBars(p: Palette, width: number, shares: readonly Share[], note: string): Drawing {
  const bars = [...shares].sort((a, b) => b.share - a.share);
  const most = Math.min(1, Math.max(...bars.map((bar) => bar.share + (bar.error ?? 0))));
  const colour = seriesColour(p, 0);
  return {
    height: 60 + 26 * bars.length,
    note,
    columns: ['gain', 'share', 'error'],
    rows: bars.map((bar) => [bar.key, bar.share, bar.error]),
    option: {
      grid: gridBox(), xAxis: axis(p, '', nice(0, Math.max(most, 0.05)), (v) => `${plain(100 * v)} %`), yAxis: rowAxis(p, bars, width),
      tooltip: tipOf((bar: Share) => tip(bar.name, [['share', percent(bar.share)], ...(bar.error === null ? [] : [['error', percent(bar.error)] as const])], colour)),
      series: [
        { type: 'bar', barWidth: 12, data: bars.map((of, i) => ({ value: [of.share, String(i)], of, itemStyle: { color: colour, opacity: 0.75 } })) },
        whiskers(bars.flatMap((bar, i) => (bar.error === null ? [] : [[Math.max(0, bar.share - bar.error), Math.min(1, bar.share + bar.error), i]])), p.ink, { level: true }),
      ],
    },
  };
}

/** The measure of each point in each world that all points met and have it in: a row per point. */
function byWorld(all: readonly Point[], { trial }: Measure): number[][] {
  const { model, slice, family } = view();
  const t = model.trials;
  const value = (row: number): number => ('outcome' in trial ? Number(t.outcome(row) === trial.outcome) : t.number(trial.metric, row));
  const series = model.series(slice, family);
  const maps = all.map((point) => {
    const rows = series.find((s) => s.controller === point.controller && s.point === point.point)?.rows ?? [];
    return new Map(rows.map((row) => [t.text('world_key', row), value(row)]));
  });
  const worlds = [...(maps[0]?.keys() ?? [])].filter((world) => maps.every((map) => Number.isFinite(map.get(world) ?? NaN)));
  return maps.map((map) => worlds.map((world) => map.get(world) ?? NaN));
}

export function gainShares(): FigureSpec {
  return {
    id: 'shares',
    title: () => `How much of the ${measure().name} each gain explains`,
    caption: 'Share of what points differ by that a gain accounts for by itself, chance taken off; bars are one standard error.',
    empty: 'Nothing can be told: all combinations of the gains\u2019 values must have run on the same worlds, and differ by more than chance.',
    choices: [kMeasureChoice],
    draw: (p, width) => {
      const of = measure();
      const all = points();
      const keys = gains(all);
      if (keys.length === 0 || new Set(all.map((point) => point.controller)).size > 1) return null;
      const values = byWorld(all, of);
      const found = effects(all.map((point) => keys.map((key) => point.values.get(key) ?? NaN)), values);
      if (found === null) return null;
      const { shares, errors } = found;
      return shareBars(p, width, keys.map((key, i) => ({ name: short(key), key, share: Math.min(1, Math.max(0, shares[i] ?? 0)), error: errors?.[i] ?? null })),
        `n = ${plural(values[0]?.length ?? 0, 'world')} that all ${integer(all.length)} points met${'metric' in of.trial ? ' and have the measure in; means, not medians' : ''}. Analysis of variance over points and worlds${errors === null ? '; too few worlds for errors' : '; errors: jackknife over twentieths of the worlds'}. What is left of 100 % is what gains do together.`);
    },
  };
}
