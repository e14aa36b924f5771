// Where the time goes: mean time of each phase of the trials that succeed, one bar per controller.

import { axis, stackedBars, tip, tipOf, type FigureSpec } from '../chart';
import type { Series } from '../data';
import { fixed, percent, plural, sizes } from '../format';
import { seriesColour } from '../theme';
import { view } from '../view';

/** Phases in the order of a motion. */
const kPhases = [
  ['standing', 'standing'], ['speeding_up', 'speeding up'], ['cruise', 'cruise'], ['slowing_down', 'slowing down'],
  ['last_5_cm', 'last 5 cm'], ['turning', 'turning at the goal'], ['dwell', 'dwell'],
] as const;

interface Bar { series: Series; n: number; seconds: number[]; sum: number }
interface Piece { bar: Bar; place: number }

function bars(): Bar[] {
  const { model: { trials }, series } = view();
  return series.flatMap((s) => {
    const rows = s.rows.filter((row) => trials.outcome(row) === 'success' && Number.isFinite(trials.number('phase_dwell_s', row)));
    const seconds = kPhases.map(([key]) => rows.reduce((sum, row) => sum + trials.number(`phase_${key}_s`, row), 0) / rows.length);
    return rows.length === 0 ? [] : [{ series: s, n: rows.length, seconds, sum: seconds.reduce((a, b) => a + b, 0) }];
  });
}

export function phases(): FigureSpec {
  return {
    id: 'phases',
    title: 'Where the time goes',
    caption: 'Mean time of the trials that succeed, by what the robot does: farther than 5 cm from the goal by its command, whose largest share of a limit grows, stays or falls; then by the errors that are left.',
    empty: 'No trial here succeeds, or the store is older than this measurement.',
    draw: (p, width) => {
      const all = bars();
      if (all.length === 0) return null;
      return {
        note: `n = ${sizes(all.map((bar) => bar.n))} trials a bar.`,
        columns: ['controller', 'point', 'phase', 'seconds', 'n'],
        rows: all.flatMap(({ series: s, seconds, n }) => kPhases.map(([key], i) => [s.controller, s.point, key, seconds[i] ?? 0, n])),
        ...stackedBars(p, width, all.map((bar) => ({ name: bar.series.short })), kPhases.map(([, name], place) => ({
          name, colour: seriesColour(p, place), data: all.map((bar) => ({ value: bar.seconds[place], of: { bar, place } })),
        })), axis(p, 'time [s]', { min: 0 }), tipOf(({ bar, place }: Piece) => tip(kPhases[place]?.[1] ?? '', [
          ['controller', bar.series.short], ['mean', `${fixed(bar.seconds[place] ?? 0, 2)} s of ${fixed(bar.sum, 2)} s`],
          ['share', percent((bar.seconds[place] ?? 0) / bar.sum)], ['of', plural(bar.n, 'trial')],
        ], seriesColour(p, place)))),
      };
    },
  };
}
