// Outcomes of trials: one bar per controller, within each family.

import { kNarrow, shareAxis, stackedBars, tip, tipOf, type FigureSpec } from '../chart';
import { inkOn } from '../colour';
import { grouped, outcomeName, kOutcomes, type Outcome, type Series } from '../data';
import { integer, percent, plural, sizes } from '../format';
import { goToSection } from '../go_to';
import * as state from '../state';
import { outcomeColour } from '../theme';
import { byFamily, view } from '../view';

interface Bar { family: string; series: Series; counts: Map<Outcome, number[]>; n: number }
/** Width of a digit of a count [px]. */
const kDigit = 7;

/** The trials of a bar that ended alike. */
interface Piece { bar: Bar; outcome: Outcome; count: number }

export function outcomes(): FigureSpec {
  return {
    id: 'outcomes',
    title: 'How trials ended',
    caption: 'Every trial has exactly one outcome; a bar is all trials of a controller in a family of worlds. A click lists the trials.',
    empty: 'No trial here has a result.',
    draw: (p, width) => {
      const { families, model: { trials } } = view();
      const all = byFamily().map(({ rows, ...of }): Bar => ({ ...of, n: rows.length, counts: grouped(rows, (row) => trials.outcome(row)) }));
      if (all.length === 0) return null;
      const present = kOutcomes.filter((o) => all.some((bar) => bar.counts.has(o)));
      const several = families.length > 1;
      const rows = all.map((bar) => ({ name: bar.series.short, family: several ? bar.family : '' }));
      const pieces = (outcome: Outcome): Piece[] => all.map((bar) => ({ bar, outcome, count: bar.counts.get(outcome)?.length ?? 0 }));
      // Names take up to half of a narrow plot.
      const room = (width < kNarrow ? 0.5 : 0.6) * width;
      const fits = ({ count, bar: { n } }: Piece): boolean => (count / n) * room > kDigit * (integer(count).length + 1);
      return {
        note: `n = ${sizes(all.map((bar) => bar.n))} trials a bar; counts are written where they fit.`,
        columns: ['family', 'controller', 'point', 'outcome', 'trials', 'share', 'n'],
        rows: present.flatMap(pieces).map(({ bar, outcome, count }) => [bar.family, bar.series.controller, bar.series.point, outcome, count, count / bar.n, bar.n]),
        ...stackedBars(p, width, rows, present.map((o) => ({
          name: outcomeName(o), colour: outcomeColour(p, o), data: pieces(o).map((of) => ({ value: of.count / of.bar.n, of })),
          label: { show: true, color: inkOn(outcomeColour(p, o)), fontSize: 11.5, formatter: ({ data: { of } }: { data: { of: Piece } }) => (fits(of) ? integer(of.count) : '') },
        })), shareAxis(p, width < kNarrow ? 0.5 : 0.2, { splitLine: { show: false } }), tipOf(({ bar, outcome, count }: Piece) => tip(outcomeName(outcome), [
          ['controller', bar.series.short], ['family', bar.family], ['trials', `${integer(count)} of ${plural(bar.n, 'trial')}`], ['share', percent(count / bar.n)],
        ], outcomeColour(p, outcome)))),
      };
    },
    click: (of: Piece) => {
      state.set({ outcome: of.outcome, who: of.bar.series.controller, q: [of.bar.family, of.bar.series.point].filter((text) => /^\S+$/.test(text)).join(' '), in: 'trials' }, true);
      goToSection('trials');
    },
  };
}
