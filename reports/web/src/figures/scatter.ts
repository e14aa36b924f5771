// Any metric against any other: one dot per trial.

import { axis, nice, plots, tip, tipOf, type FigureSpec } from '../chart';
import { outcomeName } from '../data';
import { fixed, integer, upper } from '../format';
import { axisName, withUnit } from '../metrics';
import { chosenRow, select } from '../select';
import { extent, spearman, thinned } from '../stats';
import { seriesColour, symbolOf } from '../theme';
import { view } from '../view';
import { metricChoice } from './distribution';

/** More dots than this hide each other. */
const kMostDots = 20000;
/** Dots of more controllers are no longer told apart: each is then drawn in a plot of its own. */
const kTogether = 6;

function correlation(rho: ReturnType<typeof spearman>): string {
  if (rho === null) return 'none, all values being equal';
  return fixed(rho.value, 2) + (rho.interval === null ? ' (no interval of so few)' : ` (95 % interval ${fixed(rho.interval.low, 2)} to ${fixed(rho.interval.high, 2)})`);
}

export function scatter(): FigureSpec {
  const x = metricChoice('f.sx', 'Along x', 'goal_distance_m');
  const y = metricChoice('f.sy', 'Along y', 'manip_mean');
  return {
    id: 'scatter',
    title: () => `${upper(y.of().name)} against ${x.of().name}`,
    caption: () => `Each dot is one trial that has both; hollow where it failed. ${view().model.clickPlays()}`,
    empty: 'No trial here has both metrics.',
    linked: true,
    choices: [x.choice, y.choice],
    draw: (p, width) => {
      const { model, series } = view();
      const t = model.trials;
      const [mx, my] = [x.of(), y.of()];
      const groups = series.map((s) => ({
        s, dots: s.rows.map((row) => ({ row, x: t.number(mx.key, row), y: t.number(my.key, row) })).filter((d) => Number.isFinite(d.x) && Number.isFinite(d.y)),
      })).filter((g) => g.dots.length > 0);
      const [xs, ys] = [extent(groups.flatMap((g) => g.dots.map((d) => d.x))), extent(groups.flatMap((g) => g.dots.map((d) => d.y)))];
      if (xs === null || ys === null) return null;
      const chosen = chosenRow(model);
      const total = groups.reduce((sum, g) => sum + g.dots.length, 0);
      return {
        note: groups.map((g) => `${g.s.short}: n = ${integer(g.dots.length)}, rank correlation ${correlation(spearman(g.dots.map((d) => d.x), g.dots.map((d) => d.y)))}`).join('; ')
          + (total > kMostDots ? `. ${integer(kMostDots)} dots are drawn.` : '.'),
        columns: ['controller', 'point', 'trial', 'outcome', mx.key, my.key],
        rows: groups.flatMap((g) => g.dots.map((d) => [g.s.controller, g.s.point, t.text('trial', d.row), t.outcome(d.row), d.x, d.y])),
        ...plots(p, width, {
          groups: groups.map((g) => g.s), most: kTogether, height: 420,
          x: (marks) => axis(p, axisName(mx), nice(...xs, marks)), y: axis(p, axisName(my), { ...nice(...ys, groups.length > kTogether ? 3 : 6), nameGap: 46 }),
          series: (place, alone) => {
            const { s, dots } = groups[place]!;
            const colour = seriesColour(p, s.mark);
            return [{
              name: s.short, type: 'scatter', symbol: alone ? 'circle' : symbolOf(s.mark), symbolSize: alone ? 5 : 7, itemStyle: { color: colour }, cursor: 'pointer',
              data: thinned(dots.length, Math.ceil((kMostDots * dots.length) / Math.max(total, kMostDots))).map((i) => {
                const { row, x: across, y: up } = dots[i]!;
                const filled = t.success(row);
                if (row === chosen) return { value: [across, up], of: row, symbolSize: 14, itemStyle: { color: colour, borderColor: p.ink, borderWidth: 2.5 } };
                return { value: [across, up], of: row, itemStyle: { color: filled ? colour : 'transparent', borderColor: colour, borderWidth: filled ? 0 : 1.2, opacity: filled ? 0.55 : 0.8 } };
              }),
            }];
          },
          tooltip: tipOf((row: number) => tip(`${t.text('controller', row)}, ${t.text('family', row)} world ${integer(t.number('world', row))}`, [
            ['outcome', outcomeName(t.outcome(row))], [mx.name, withUnit(mx, t.number(mx.key, row))], [my.name, withUnit(my, t.number(my.key, row))],
          ])),
        }),
      };
    },
    click: (row: number) => select(view().model.trials.text('trial', row), true),
  };
}
