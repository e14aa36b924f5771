// What changed from one store, or one version of a controller, to the next: setting by setting, as the store's reader found.

import { inSlice, type Change, type Model } from '../data';
import { h } from '../dom';
import { view } from '../view';

/** More than these of one pair are told in number only. */
const kMost = 12;

/** "lambda_q: 0.01 → 0.02" */
function text({ key, from, to }: Change['differs'][number]): string {
  return `${key}: ${from ?? 'not set'} → ${to ?? 'not set'}`;
}

/** A line for each version of a controller against the one before it; null where there is one of each. */
export function changes(model: Model): HTMLElement | null {
  const lines = (model.page.changes ?? []).filter((c) => inSlice(c, view().slice)).map(({ controller, before, differs }) => {
    const more = differs.length > kMost ? `, and ${differs.length - kMost} more` : '';
    return h('li', null, h('b', null, controller), differs.length === 0 ? ` has the settings of ${before}.` : ` differs from ${before} in ${differs.slice(0, kMost).map(text).join('; ')}${more}.`);
  });
  return lines.length === 0 ? null : h('div', { class: 'changes' }, h('h3', null, 'What changed'), h('ul', null, ...lines));
}
