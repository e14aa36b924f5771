// Success rate against what makes a world hard, in bins of about equal size.

import { axis, kNarrow, nice, plots, shareAxis, tip, tipOf, whiskers, type FigureSpec } from '../chart';
import { integer, percent, percentRange, sizes } from '../format';
import { axisName, kMetrics } from '../metrics';
import { wilson } from '../stats';
import { dashOf, seriesColour, symbolOf } from '../theme';
import { view } from '../view';
import { metricChoice } from './distribution';

const kBins = 6;
/** Intervals of more lines than this hide each other: each is then drawn in a plot of its own. */
const kTogether = 4;

/** Inner edges of bins that hold about equally many of `values`; distinct. */
function edges(values: number[]): number[] {
  const sorted = [...values].sort((a, b) => a - b);
  const inner = Array.from({ length: kBins - 1 }, (_, i) => sorted[Math.floor(((i + 1) * sorted.length) / kBins)] ?? 0);
  return [...new Set(inner)].filter((edge) => edge > (sorted[0] ?? 0));
}

interface Bin { name: string; colour: string; x: number; hits: number; n: number; low: number; high: number; from: number; to: number }

export function difficulty(): FigureSpec {
  const chosen = metricChoice('f.difficulty', 'Against', 'goal_distance_m', () => kMetrics.filter((m) => m.of === 'world'));
  return {
    id: 'difficulty',
    title: () => `Success against ${chosen.of().name}`,
    caption: 'Worlds in bins of about equal number; each point is the success rate in its bin, at the mean difficulty, with its 95 % interval.',
    empty: 'Nothing varies here among the worlds shown.',
    choices: [chosen.choice],
    draw: (p, width) => {
      const of = chosen.of();
      const { model, series } = view();
      const t = model.trials;
      const all = series.flatMap((s) => s.rows.map((row) => t.number(of.key, row)).filter(Number.isFinite));
      const inner = edges(all);
      if (inner.length === 0) return null;
      const lines = series.map((s) => {
        const found: number[][] = Array.from({ length: inner.length + 1 }, () => []);
        for (const row of s.rows) {
          const x = t.number(of.key, row);
          if (Number.isFinite(x)) found[inner.filter((edge) => x >= edge).length]!.push(row);
        }
        return { s, bins: found.filter((rows) => rows.length > 0).map((rows): Bin => {
          const [xs, hits] = [rows.map((row) => t.number(of.key, row)), rows.filter((row) => t.success(row)).length];
          return { name: s.short, colour: seriesColour(p, s.mark), n: rows.length, hits, ...wilson(hits, rows.length), x: xs.reduce((sum, x) => sum + x, 0) / rows.length, from: Math.min(...xs), to: Math.max(...xs) };
        }) };
      }).filter((line) => line.bins.length > 0);
      const bins = lines.flatMap((line) => line.bins);
      const centres = bins.map((bin) => bin.x);
      const [least, most] = [Math.min(...centres), Math.max(...centres)];
      // Side by side, since intervals of equal place would hide one another.
      const aside = (i: number, alone: boolean): number => (alone ? 0 : (i - (lines.length - 1) / 2) * (most - least) * (width < kNarrow ? 0.022 : 0.008));
      const unused = series.reduce((sum, s) => sum + s.rows.length, 0) - all.length;
      return {
        note: `n = ${sizes(bins.map((bin) => bin.n))} trials a point; 95 % Wilson.${unused > 0 ? ` ${integer(unused)} trials have no such value.` : ''}`,
        columns: ['controller', 'point', `${of.key}_from`, `${of.key}_to`, `${of.key}_mean`, 'successes', 'n', 'success_rate', 'success_low', 'success_high'],
        rows: lines.flatMap(({ s, bins: own }) => own.map((b) => [s.controller, s.point, b.from, b.to, b.x, b.hits, b.n, b.hits / b.n, b.low, b.high])),
        ...plots(p, width, {
          groups: lines.map((line) => line.s), most: kTogether, height: 350,
          x: (marks) => axis(p, axisName(of), { ...nice(least, most, marks), ...(lines.length > kTogether ? {} : { max: most + 0.02 * (most - least), axisLabel: { showMaxLabel: false } }) }), y: shareAxis(p, 0.25),
          end: (i) => { const b = lines[i]!.bins[lines[i]!.bins.length - 1]!; return [b.x + aside(i, false), b.hits / b.n]; },
          series: (i, alone) => {
            const { s, bins: own } = lines[i]!;
            const colour = seriesColour(p, s.mark);
            return [
              whiskers(own.map((b) => [b.x + aside(i, alone), b.low, b.high]), colour, { width: 1.6 }),
              {
                name: s.short, type: 'line', data: own.map((b) => ({ value: [b.x + aside(i, alone), b.hits / b.n], of: b })), symbol: alone ? 'circle' : symbolOf(s.mark), symbolSize: alone ? 7 : 9, clip: false,
                lineStyle: { color: colour, width: 1.6, type: alone ? 'solid' : dashOf(s.mark) }, itemStyle: { color: colour }, emphasis: { disabled: true }, z: 4,
              },
            ];
          },
          tooltip: tipOf((b: Bin) => tip(b.name, [
            [of.name, `${of.write(b.from)} \u2026 ${of.write(b.to)} ${of.unit}`], ['success', `${integer(b.hits)} of ${integer(b.n)}: ${percent(b.hits / b.n)}`], ['95 % interval', percentRange(b.low, b.high)],
          ], b.colour)),
        }),
      };
    },
  };
}
