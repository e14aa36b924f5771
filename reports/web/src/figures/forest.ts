// Success of every controller with its interval: a row each, the best first where they are many.

import { gridBox, kNarrow, rowAxis, rowHeight, ruler, shareAxis, tip, tipOf, whiskers, type FigureSpec } from '../chart';
import type { Series, SummaryRow } from '../data';
import { integer, percent, percentRange, plural, sizes } from '../format';
import { seriesColour } from '../theme';
import { baseline, kFew, resultOf, view } from '../view';

/** More rows than this are no picture; the table has them all. */
const kMost = 60;

interface Line { series: Series; row: SummaryRow; family: string }

function lines(): Line[] {
  const { family, families, all } = view();
  const of = (name: string): Line[] => all.flatMap((series) => {
    const row = resultOf(series, name);
    return row === undefined ? [] : [{ series, row, family: name }];
  });
  if (all.length > kFew) return of(family).sort((a, b) => b.row.success_rate - a.row.success_rate).slice(0, kMost);
  return family !== '' ? of(family) : [...of(''), ...(families.length > 1 ? families.flatMap(of) : [])];
}

export function forest(): FigureSpec {
  return {
    id: 'forest',
    title: 'Success rate of every controller',
    caption: 'A dot per controller with its 95 % Wilson interval.',
    empty: 'No trial here has a result.',
    draw: (p, width) => {
      const all = lines();
      const { all: series, families } = view();
      if (all.length === 0) return null;
      const base = baseline();
      const many = series.length > kFew;
      const several = !many && families.length > 1;
      const rows = all.map((l) => ({ name: l.series.short, family: !several ? '' : l.family === '' ? 'all worlds' : l.family }));
      const against = many ? all.find((l) => l.series === base)?.row.success_rate : undefined;
      const colour = (i: number): string => seriesColour(p, all[i]?.series.mark ?? -1);
      return {
        height: 56 + all.length * rowHeight(rows, width, all.length > 24 ? 17 : 24),
        note: [
          `n = ${sizes(all.map((l) => l.row.n))} trials a row; 95 % Wilson, each by itself.`,
          against === undefined ? '' : 'The broken line is the baseline: the first controller, unless another is chosen under Pairs.',
          many ? `The best stand first. The best of ${plural(series.length, series.some((s) => s.point !== '') ? 'point' : 'controller')} looks better on the worlds that chose it than it is: confirm it on others.` : '',
          series.length > kMost ? `The best ${integer(kMost)} are shown.` : '',
        ].filter((text) => text !== '').join(' '),
        columns: ['family', 'controller', 'point', 'n', 'success_rate', 'success_low', 'success_high'],
        rows: all.map((l) => [l.family, l.series.controller, l.series.point, l.row.n, l.row.success_rate, l.row.success_low, l.row.success_high]),
        option: {
          grid: gridBox(), xAxis: shareAxis(p, width < kNarrow ? 0.5 : 0.2),
          yAxis: rowAxis(p, rows, width, all.length > 24 ? 11 : 12.5),
          tooltip: tipOf(({ series: s, row: r }: Line) => tip(s.name, [['success', percent(r.success_rate)], ['95 % interval', percentRange(r.success_low, r.success_high)], ['n', integer(r.n)]], seriesColour(p, s.mark))),
          series: [
            ...(against === undefined ? [] : [ruler(p, [against, '0'], [against, String(all.length - 1)])]),
            whiskers(all.map((l, i) => [l.row.success_low, l.row.success_high, i]), colour, { level: true, width: 2 }),
            { type: 'scatter', symbolSize: all.length > 24 ? 7 : 9, z: 4, data: all.map((of, i) => ({ value: [of.row.success_rate, String(i)], of, itemStyle: { color: colour(i) } })) },
          ],
        },
      };
    },
  };
}
