// Rare events (moma risk): their probabilities, and how a score's exceedances lead to them.

import { axis, bandSeries, nice, pathSeries, plots, tip, tipOf, whiskers, type FigureSpec } from '../chart';
import { grouped, type Model, type RiskEstimate } from '../data';
import { h, table } from '../dom';
import { figure } from '../figure';
import { integer, plural, significant, upper } from '../format';
import { axisName, metric, withUnit } from '../metrics';
import { dashOf, seriesColour, symbolOf } from '../theme';

type Estimate = RiskEstimate & { suite: string };

/** Wider names and more curves do not fit into one plot. */
const kTogether = 4;

function nameOf(r: Estimate): string {
  return [r.controller, r.point, r.family].filter((part) => part !== '').join(' \u00b7 ');
}

const range = (low: number, high: number): string => `${significant(low, 2)} to ${significant(high, 2)}`;

function exceedances(of: readonly Estimate[], id: string): FigureSpec {
  const { event, level, suite } = of[0]!;
  const score = metric(level);
  return {
    id: `risk${id}`,
    title: `Probability of ${event} in ${suite}, and the way there`,
    caption: `Probability that a trial comes as near to the event as the ${score.name} says, by splitting with its 95 % interval; rings: share of the crude trials among its first draws. The last point of a curve is the event.`,
    empty: 'No world came near the event.',
    draw: (p, width) => {
      const curves = of.filter((r) => r.family !== 'all').map((r, mark) => {
        const event_ = r.at === null || !(r.p > 0) ? [] : [[r.at, r.p, r.low, r.high, r.crude] as const];
        const points = [...r.way, ...event_].filter(([, q]) => q > 0).map(([x, q, low, high, crude]) => ({ r, x, q, low, high, crude }));
        return { short: nameOf(r), mark, points };
      }).filter((curve) => curve.points.length > 0);
      const all = curves.flatMap((curve) => curve.points);
      if (all.length === 0) return null;
      const y = Math.log10;
      const xs = all.map((q) => q.x);
      const least = Math.floor(Math.min(...all.map((q) => y(q.low > 0 ? q.low : q.q))));
      return {
        note: curves.map(({ short, points }) => { const r = points[0]!.r; return `${short}: ${plural(r.trials, 'trial')}, ${plural(r.replicates, 'replicate')}`; }).join('; ') + '. Bands: pointwise 95 %, log-normal over replicates.',
        columns: ['controller', 'point', 'family', 'event', level, 'p', 'low', 'high', 'crude'],
        rows: all.map((q) => [q.r.controller, q.r.point, q.r.family, q.r.event, q.x, q.q, q.low, q.high, q.crude]),
        ...plots(p, width, {
          groups: curves, most: kTogether,
          x: (marks) => axis(p, axisName(score), nice(Math.min(...xs), Math.max(...xs), marks)),
          y: axis(p, 'probability', { min: least, max: 0, interval: Math.ceil(-least / 8), nameGap: 44 }, (v) => (v === 0 ? '1' : significant(10 ** v, 1))),
          series: (i, alone) => {
            const { short, mark, points } = curves[i]!;
            const colour = seriesColour(p, mark);
            const line = (value: (q: (typeof points)[number]) => number): [number, number][] => points.map((q) => [q.x, Math.max(least, y(value(q)))]);
            const end = points[points.length - 1]!;
            return [
              bandSeries(line((q) => q.low), line((q) => q.high), colour, p.dark ? 0.16 : 0.12),
              pathSeries(short, line((q) => q.q), { colour, width: 2, dash: alone ? 'solid' : dashOf(mark) }, { silent: true, z: 5 }),
              whiskers([[end.x, y(end.low > 0 ? end.low : end.q), y(end.high)]], colour, { width: 2 }),
              { type: 'scatter', name: short, symbolSize: 6, symbol: 'circle', z: 4, silent: true, itemStyle: { color: 'transparent', borderColor: colour, borderWidth: 1.2 }, data: points.filter((q) => q.crude > 0).map((q) => [q.x, y(q.crude)]) },
              { type: 'scatter', name: short, symbolSize: 8, symbol: symbolOf(mark), z: 6, itemStyle: { color: colour }, data: points.map((q) => ({ value: [q.x, y(q.q)], of: q, symbolSize: q === end ? 9 : 4 })) },
            ];
          },
          tooltip: tipOf((q: (typeof all)[number]) => tip(nameOf(q.r), [
            [score.name, withUnit(score, q.x)], ['probability', significant(q.q, 2)], ['95 % interval', range(q.low, q.high)], ['among first draws', significant(q.crude, 2)],
          ])),
        }),
      };
    },
  };
}

/** The latest estimates of one event in one suite each, by point and family. */
function groups(model: Model): Estimate[][] {
  const all = model.page.invocations.flatMap((i) => (i.risk ?? []).map((r): Estimate => ({ suite: i.suite, ...r })));
  const latest = new Map(all.reverse().map((r) => [[r.suite, r.controller, r.point, r.event, r.family].join('\n'), r]));
  return [...grouped([...latest.values()], (r) => `${r.suite}\n${r.event}`).values()];
}

export function riskFigures(model: Model): FigureSpec[] {
  return groups(model).map((of, i) => exceedances(of, i === 0 ? '' : String(i + 1)));
}

export function risk(model: Model): Node[] {
  const figures = riskFigures(model);
  return groups(model).flatMap((of, i) => [
    h('div', { class: 'panel' },
      table(`Probability of ${of[0]!.event}`, ['Controller and family', upper(of[0]!.event), 'Trials', 'Crude trials', 'Spread / ideal', 'Ancestors'], of.map((r) => [
        nameOf(r), r.refused ? 'no estimate' : [h('b', null, significant(r.p, 2)), h('small', null, range(r.low, r.high))],
        [integer(r.trials), h('small', null, plural(r.replicates, 'replicate'))], [significant(r.crude, 2), h('small', null, `${range(r.crude_low, r.crude_high)}, n = ${integer(r.crude_trials)}`)],
        significant(r.excess, 2), integer(r.ancestors),
      ]), 'risk'),
      h('p', { class: 'note' }, 'Splitting, 95 % log-normal intervals over replicates. Spread / ideal above 2 is doubtful, above 3 there is no estimate. Regions that no replicate reached show in none of these numbers.')),
    figure(figures[i]!),
  ]);
}
