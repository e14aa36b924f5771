// Manipulability along the motion of the trials whose samples are at hand.

import { axis, nice, plots, tip, tipOf, type FigureSpec } from '../chart';
import { outcomeName, type Model, type Series } from '../data';
import { fixed, integer } from '../format';
import { decode, type Trace } from '../replay/trace';
import { chosenRow, select } from '../select';
import { outcomeColour, seriesColour } from '../theme';
import { view } from '../view';

/** More lines than this are a blur. */
const kMost = 40;
/** Lines of more controllers are no longer told apart: those of each are then in a plot of its own. */
const kTogether = 6;

interface Group { s: Series; courses: { row: number; trace: Trace }[] }

export function course(model: Model): FigureSpec {
  const known = new Map<string, Trace>();
  const trials = (): string[] => model.page.replays.slice(0, kMost).map(({ trial }) => trial);

  /** What the page itself holds is read when it is first drawn, on paper too. The replay says what is wrong with a motion. */
  const readOwn = (): void => {
    for (const trial of trials()) {
      const replay = known.has(trial) ? undefined : model.embedded(trial)?.replay;
      try {
        if (replay !== undefined) known.set(trial, decode(replay));
      } catch {
        known.delete(trial);
      }
    }
  };

  const groups = (): Group[] => view().series.map((s) => ({
    s, courses: s.rows.flatMap((row) => { const trace = known.get(model.trials.text('trial', row)); return trace === undefined ? [] : [{ row, trace }]; }),
  })).filter((g) => g.courses.length > 0);

  return {
    id: 'course',
    title: 'Manipulability along the motion',
    caption: () => `One line per trial whose motion is at hand, from its start to its end; broken where it failed. ${model.clickPlays()}`,
    empty: 'No motion of these trials is at hand.',
    linked: true,
    ...(model.page.live === undefined ? {} : { prepare: async () => {
      for (const trial of trials()) await model.motion(trial).then(({ replay }) => known.set(trial, decode(replay)), () => known.delete(trial));
    } }),
    draw: (p, width) => {
      readOwn();
      const all = groups();
      const end = Math.max(0, ...all.flatMap((g) => g.courses.map((c) => c.trace.end)));
      if (!(end > 0)) return null;
      const t = model.trials;
      const chosen = chosenRow(model);
      return {
        note: all.map((g) => `${g.s.short}: n = ${integer(g.courses.length)}`).join('; ') + '. These are the trials chosen for replay, the worst of each kind first: not a sample of all.',
        columns: ['controller', 'point', 'trial', 't_s', 'manipulability'],
        rows: all.flatMap((g) => g.courses.flatMap((c) => [...c.trace.t].map((at, i) => [g.s.controller, g.s.point, t.text('trial', c.row), at, c.trace.column('manipulability')[i] ?? null]))),
        ...plots(p, width, {
          groups: all.map((g) => g.s), most: kTogether, x: (marks) => axis(p, 'time [s]', nice(0, end, marks)), y: axis(p, 'manipulability', { min: 0, nameGap: 46 }),
          series: (place) => (all[place]?.courses ?? []).map(({ row, trace }) => {
            const colour = seriesColour(p, all[place]!.s.mark);
            return {
              name: all[place]!.s.short, type: 'line', showSymbol: false, triggerEvent: 'line', cursor: 'pointer', z: 2,
              data: [...trace.t].map((at, i) => ({ value: [at, trace.column('manipulability')[i] ?? null], of: row })),
              lineStyle: { color: colour, width: row === chosen ? 3 : 1.1, opacity: row === chosen ? 1 : 0.65, type: t.success(row) ? 'solid' : [4, 3] }, itemStyle: { color: colour }, emphasis: { disabled: true },
            };
          }),
          tooltip: tipOf((row: number) => tip(`${t.text('controller', row)}, ${t.text('family', row)} world ${integer(t.number('world', row))}`, [['outcome', outcomeName(t.outcome(row))], ['least', fixed(t.number('manip_min', row), 4)], ['mean', fixed(t.number('manip_mean', row), 4)]], outcomeColour(p, t.outcome(row)))),
        }),
      };
    },
    click: (_, { seriesIndex }) => {
      const found = groups().flatMap((g) => g.courses)[seriesIndex];   // a line each, in this order
      if (found !== undefined) select(model.trials.text('trial', found.row), true);
    },
  };
}
