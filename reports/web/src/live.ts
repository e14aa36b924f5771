// The page of `moma view`: asks the server whether the store has changed, and shows what came.

import { ask, type Model, type PageData } from './data';
import { h, replace } from './dom';
import { plural } from './format';
import { isSwept } from './figures/sweep';
import { refreshView } from './view';

interface State { trials: number; running: boolean; token: string }

const kPause = 3000;

/** A line that says what the store is doing, kept up to date while the page is looked at. */
export function liveLine(model: Model): HTMLElement | null {
  if (model.page.live === undefined) return null;
  const line = h('p', { class: 'live', role: 'status' }, `${plural(model.page.trials.stored, 'trial')}, served live.`);
  let shown = model.page.live.token;
  let pause = kPause;

  const update = async (): Promise<void> => {
    const began = performance.now();
    const page = await ask('data.json') as PageData;
    const other = (model.trials.n === 0) !== (page.trials.n === 0) || page.tuning.length !== model.page.tuning.length;
    const swept = isSwept(model);
    model.load(page);
    if (other || swept !== isSwept(model)) {
      location.reload();   // sections come or go
      return;
    }
    shown = page.live?.token ?? shown;
    refreshView();
    // A large store must not keep the machine busy with showing it.
    pause = Math.max(kPause, 10 * (performance.now() - began));
  };

  const look = async (): Promise<void> => {
    try {
      if (!document.hidden) {
        const now = await ask('state.json') as State;
        if (now.token !== shown) await update();
        replace(line, `${plural(now.trials, 'trial')}${now.running ? '; a run goes on, and this page follows it.' : '; no run is going on.'}`);
        line.classList.toggle('running', now.running);
      }
    } catch (error) {
      line.classList.remove('running');
      replace(line, error instanceof TypeError ? 'moma view has ended: this is what the store held last.' : `The store cannot be read now: ${error instanceof Error ? error.message : String(error)}`);
    }
    setTimeout(() => void look(), pause);
  };
  setTimeout(() => void look(), kPause);
  return line;
}
