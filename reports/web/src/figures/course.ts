// Manipulability along the motion of the trials whose samples are at hand.

import { axis, legend, legendHeight, nice, plain, smallMultiples, tip, type FigureSpec, type Option } from '../chart';
import { outcomeName, type Model } from '../data';
import { fixed, integer } from '../format';
import { decode, type Trace } from '../replay/trace';
import { select } from '../select';
import { outcomeColour, seriesColour, seriesInk, type Palette } from '../theme';
import { view } from '../view';

/** More lines than this are a blur. */
const kMost = 40;
/** Lines of more controllers are no longer told apart: those of each are then in a plot of its own. */
const kTogether = 6;

interface Course { row: number; trace: Trace }

export function course(model: Model): FigureSpec {
  const known = new Map<string, Trace>();

  /** What the page itself holds is read when it is first drawn, on paper too. */
  const readOwn = (): void => {
    for (const { trial } of model.page.replays.slice(0, kMost)) {
      const replay = known.has(trial) ? undefined : model.embedded(trial)?.replay;
      if (replay === undefined) continue;
      try {
        known.set(trial, decode(replay));
      } catch {
        continue;   // as above
      }
    }
  };

  const shown = (): { s: ReturnType<typeof view>['series'][number]; courses: Course[] }[] => {
    const { series } = view();
    const place = new Map(series.flatMap((s) => s.rows.map((row) => [model.trials.text('trial', row), row] as const)));
    const rows = new Map<number, Trace>();
    for (const [trial, trace] of known) {
      const row = place.get(trial);
      if (row !== undefined) rows.set(row, trace);
    }
    return series.map((s) => ({ s, courses: s.rows.flatMap((row) => { const trace = rows.get(row); return trace === undefined ? [] : [{ row, trace }]; }) })).filter((g) => g.courses.length > 0);
  };

  return {
    id: 'course',
    title: 'Manipulability along the motion',
    caption: () => `One line per trial whose motion is at hand, from its start to its end; broken where it failed. ${model.clickPlays()}`,
    empty: 'No motion of these trials is at hand.',
    ...(model.page.live === undefined ? {} : { prepare: async () => {
      for (const { trial } of model.page.replays.slice(0, kMost)) {
        try {
          known.set(trial, decode((await model.motion(trial)).replay));
        } catch {
          known.delete(trial);   // the replay says what is wrong with it
        }
      }
    } }),
    draw: (p: Palette, width: number) => {
      readOwn();
      const groups = shown();
      if (groups.length === 0) return null;
      const end = Math.max(...groups.flatMap((g) => g.courses.map((c) => c.trace.end)));
      if (!(end > 0)) return null;
      const names = groups.map((g) => g.s.short);
      const xAxis = axis(p, 'time [s]', { ...nice(0, end, groups.length > kTogether ? 3 : 6), nameGap: 26 });
      const yAxis = axis(p, 'manipulability', { min: 0, nameGap: 46, axisLabel: { color: p.muted, fontSize: 11, formatter: plain } });
      // Lines in this order, and before all else: click() and the tooltip find theirs by its place.
      const drawn = (g: (typeof groups)[number]): Option[] => g.courses.map((c) => ({
        type: 'line', showSymbol: false, triggerEvent: 'line', cursor: 'pointer', z: 2,
        data: [...c.trace.t].map((t, i) => ({ value: [t, c.trace.column('manipulability')[i] ?? null], row: c.row })),
        lineStyle: { color: seriesColour(p, g.s.mark), width: 1.1, opacity: 0.65, type: model.trials.success(c.row) ? 'solid' : [4, 3] }, itemStyle: { color: seriesColour(p, g.s.mark) }, emphasis: { disabled: true },
      }));
      const tooltip = {
        trigger: 'item',
        formatter: ({ seriesIndex }: { seriesIndex: number }) => {
          const row = groups.flatMap((g) => g.courses)[seriesIndex]?.row;
          if (row === undefined) return '';
          const t = model.trials;
          return tip(`${t.text('controller', row)}, ${t.text('family', row)} world ${integer(t.number('world', row))}`, [['outcome', outcomeName(t.outcome(row))], ['least', fixed(t.number('manip_min', row), 4)], ['mean', fixed(t.number('manip_mean', row), 4)]], outcomeColour(p, t.outcome(row)));
        },
      };
      return {
        note: groups.map((g) => `${g.s.short}: n = ${integer(g.courses.length)}`).join('; ') + '. These are the trials chosen for replay, the worst of each kind first: not a sample of all.',
        columns: ['controller', 'point', 'trial', 't_s', 'manipulability'],
        rows: groups.flatMap((g) => g.courses.flatMap((c) => [...c.trace.t].map((t, i) => [g.s.controller, g.s.point, model.trials.text('trial', c.row), t, c.trace.column('manipulability')[i] ?? null]))),
        ...(groups.length <= kTogether ? {
          height: 380,
          option: {
            legend: legend(p, names), xAxis, yAxis, tooltip,
            grid: { left: 8, right: 20, top: legendHeight(names, width), bottom: 8, outerBoundsMode: 'same', outerBoundsContain: 'all' },
            series: [...groups.flatMap(drawn), ...groups.map((g) => ({ name: g.s.short, type: 'line', data: [], silent: true, itemStyle: { color: seriesColour(p, g.s.mark) } }))],   // the legend's
          },
        } : smallMultiples(width, groups.map((g) => ({ title: g.s.short, colour: seriesInk(p, g.s.mark) })), xAxis, yAxis, (place) => drawn(groups[place]!), tooltip)),
      };
    },
    click: (_, { seriesIndex }) => {
      const course = shown().flatMap((g) => g.courses)[seriesIndex];   // lines come first, in this order
      if (course !== undefined) select(model.trials.text('trial', course.row), true);
    },
  };
}
