// The replay section: choose a trial, play it, scrub, look around.

import { disturbed } from '../conditions';
import { outcomeName, type Model, type Motion } from '../data';
import { downloadBlob, h, replace, roving } from '../dom';
import { fixed, integer, plural } from '../format';
import { whenSeen } from '../later';
import { onPaper, paperPlace } from '../paper';
import { onSelect, select } from '../select';
import { command } from '../sections/trials';
import * as state from '../state';
import { outcomeColour, onTheme, palette } from '../theme';
import { onView } from '../view';
import { canFilm, Film } from './film';
import { readLook, type Part } from './look';
import { Plate, type Words } from './plate';
import { Robot } from './robot';
import { collisionParameters, type Row } from './rows';
import { ReplayScene, type Colours, type WorldJson } from './scene';
import { statusAt, Timeline } from './timeline';
import { decode, type Trace } from './trace';

/** Frames a second of a saved motion. */
const kFps = 30;

const kSpeeds = [0.25, 0.5, 1, 2, 4] as const;

function colours(): Colours {
  const p = palette();
  return p.dark
    ? { background: '#171b21', floor: '#1b2027', grid: '#2c343f', base: '#8794a6', arm: '#d7dde6', object: '#6b6257', moving: '#8a7450', hit: '#e2664c', goal: '#dcb45a', path: '#7fb0e6', begin: '#5d6570', ghost: '#cb64a3', wheel: '#4a525e' }
    : { background: '#eeece6', floor: '#f4f2ed', grid: '#d8d4c9', base: '#5d6b7e', arm: '#f7f8fa', object: '#b5ab9b', moving: '#cfae74', hit: '#c4472f', goal: '#c79a2b', path: '#27598f', begin: '#9db4cc', ghost: '#b8447b', wheel: '#3a424d' };
}

/** Trials to choose from: the worst of each kind with samples; where none has any but all can be asked for, failures. */
function listed(model: Model): string[] {
  const named = model.page.replays.map((replay) => replay.trial);
  const t = model.trials;
  if (named.length > 0 || model.page.live?.simulates !== true) return named;
  const rows = Array.from({ length: t.n }, (_, row) => row);
  const failed = rows.filter((row) => !t.success(row));
  return (failed.length > 0 ? failed : rows).slice(0, 24).map((row) => t.text('trial', row));
}

function shelfNote(model: Model): string {
  const [first] = model.page.replays;
  if (model.page.live !== undefined) {
    return model.page.samples_stored === 0 ? 'Any trial can be played, from the table too: it is simulated again.'
      : `The worst of each kind, of ${plural(model.page.samples_stored, 'trial')} with stored samples. Any other can be played from the table${model.page.live.simulates ? ': it is simulated again' : ''}.`;
  }
  return `${plural(model.page.replays.length, 'trial')} of ${integer(model.page.samples_stored)} with stored samples; the worst of each kind first, at ${first !== undefined && 'hz' in first ? first.hz : 10} Hz.`;
}

/** A motion from its begin to its end, frame by frame. */
export interface Reel {
  /** Resolves with the motion's length [s]. */
  begin(): Promise<number>;
  /** Frame k, which shows the time k * speed / fps, or the end. */
  add(k: number): Promise<void>;
  end(): Promise<Uint8Array>;
}

export interface Player {
  element: HTMLElement;
  /** Of the first motion of the page; null where it has none. */
  reel: ((fps: number, speed: number) => Reel) | null;
}

export function player(model: Model): Player {
  if (listed(model).length === 0) {
    const trial = model.trials.n > 0 ? model.trials.text('trial', 0) : 'TRIAL';
    const element = h('div', { class: 'empty' },
      h('p', null, model.trials.n === 0 ? 'No trials, no replays.' : 'The store keeps no samples of these trials, so none can be played here. A trial is simulated again, bit for bit, by'),
      model.trials.n === 0 ? null : h('p', { class: 'command' }, h('code', null, command(model, trial))));
    return { element, reel: null };
  }
  const canvas = h('canvas', { class: 'stage', tabindex: 0, 'aria-label': 'Replay in 3-D; drag to turn; after a click the wheel comes closer' });
  const lines = h('canvas', { class: 'timeline', 'aria-hidden': 'true' });
  const play = h('button', { type: 'button', class: 'play', click: () => toggle() }, 'Play');
  const scrub = h('input', { type: 'range', min: 0, max: 1, step: 'any', value: 0, 'aria-label': 'Time', input: () => { pause(); seek(Number(scrub.value)); } });
  const clock = h('output', { class: 'clock' });
  const speed = h('select', { 'aria-label': 'Speed', change: () => { rate = Number(speed.value); } }, ...kSpeeds.map((s) => h('option', { value: s, selected: s === 1 }, `${s}\u00d7`)));
  const follow = h('input', { type: 'checkbox', change: () => { if (scene !== null) scene.follow = follow.checked; } });
  const home = h('button', { type: 'button', class: 'quiet', click: () => { scene?.home(); scene?.set(time); draw(); } }, 'Reset view');
  const caption = h('div', { class: 'replay-caption' });
  const joints = h('div', { class: 'joints' });
  const status = h('p', { class: 'note' });
  const shelf = roving(h('div', { class: 'shelf', role: 'listbox', 'aria-label': 'Trials that can be played' }), 'button');
  const other = h('select', { 'aria-label': 'Beside it', change: () => state.set({ beside: other.value }) });
  const otherBox = h('label', { class: 'choice', hidden: true }, h('span', null, 'beside it'), other);
  const closest = h('button', { type: 'button', class: 'quiet', click: () => jump('least') }, 'Closest approach');
  const stopped = h('button', { type: 'button', class: 'quiet', click: () => jump('end') }, 'Why it stopped');
  const asPicture = h('button', { type: 'button', class: 'quiet', click: () => savePicture() }, 'Save PNG');
  const asFilm = h('button', { type: 'button', class: 'quiet', click: () => void saveFilm() }, 'Save WebM');
  const shapes = h('input', { type: 'checkbox', change: () => { scene?.setShapes(shapes.checked); tellTriangles(); show(); } });
  const shapesBox = h('label', { hidden: true, title: 'What counts in collisions, in place of what the robot looks like' }, shapes, ' shapes');
  const legend = h('p', { class: 'replay-legend' });
  const labels = h('div', { class: 'row-labels', 'aria-hidden': 'true' });
  const near = h('p', { class: 'note rows-near' });
  const stage = h('div', { class: 'stage-box' }, canvas, labels, caption);
  const paper = paperPlace();
  let scene: ReplayScene | null = null;
  let trace: Trace | null = null;
  let robot: Robot | null = null;
  let current = '';
  let ghost: { trial: string; trace: Trace } | null = null;
  let filming: Film | null = null;
  let sees = '';   // what of the controller's senses is disturbed
  let wanted = '';
  let time = 0;
  let rate = 1;
  let playing = false;
  let frame = 0;
  let before: number | null = null;   // time of the last frame
  const timeline = new Timeline(lines, (t) => { pause(); seek(t); });
  const robots = new Map<string, Robot>();
  const looks = new Map<string, readonly Part[]>();
  const plate = new Plate();
  let words: Words = { outcome: '', colour: '', caption: '', clock: '', labels: [] };

  /** Distances at the arrows of the rows that hold the command back, and of the nearest one. */
  const drawLabels = (): void => {
    const shown = scene?.rows.filter((row, i) => row.kind !== 'passing' && (row.active || i === 0)).slice(0, 8) ?? [];
    const placed: [number, number][] = [];
    const written: { x: number; y: number; text: string; active: boolean }[] = [];
    replace(labels, ...shown.flatMap((row) => {
      const at = scene?.project(row.first.clone().add(row.second).multiplyScalar(0.5)) ?? null;
      // Nearest first: what would lie over a nearer one's label is left out; the sentence below names it.
      if (at === null || placed.some(([x, y]) => Math.abs(x - at[0]) < 62 && Math.abs(y - at[1]) < 16)) return [];
      placed.push(at);
      written.push({ x: at[0], y: at[1], text: `${fixed(1000 * row.d, 0)} mm`, active: row.active });
      return [h('span', { class: row.active ? 'active' : null, style: `left:${at[0].toFixed(1)}px;top:${at[1].toFixed(1)}px` }, `${fixed(1000 * row.d, 0)} mm`)];
    }));
    words.labels = written;
  };

  const tellRows = (): void => {
    const rows = scene?.rows ?? [];
    const active = rows.filter((row) => row.active);
    const sides = rows.filter((row) => row.kind === 'passing');
    const ends = rows.filter((row) => row.kind === 'end');
    const [first] = rows;
    const mm = (row: Row): string => `${row.link} to ${row.other} ${row.kind === 'passing' ? `(passing, ${fixed(row.d, 2)} m)` : `${fixed(1000 * row.d, 0)} mm`}`;
    const sentences = first === undefined ? ['No collision rows now: nothing is within the distance of influence.'] : [
      `${plural(rows.length, 'collision row')}${ends.length > 0 ? `, ${integer(ends.length)} of them of the ends of capsules` : ''}, ${integer(active.length)} active (the command approaches as fast as allowed)${active.length > 0 ? `: ${active.slice(0, 4).map(mm).join(', ')}` : ''}.`,
      first.kind === 'passing' ? '' : `Nearest: ${mm(first)}.`,
      sides.length > 0 ? `${plural(sides.length, 'row')} for passing objects: the long arrow points to the side that the base keeps to.` : '',
    ];
    if (sees !== '') sentences.push(`The controller saw measured poses, not these true ones (disturbed: ${sees}).`);
    near.textContent = sentences.filter((text) => text !== '').join(' ');
    const objects = rows.filter((row) => row.kind === 'object').map((row) => row.d);
    stage.dataset['leastDistance'] = objects.length > 0 ? String(Math.min(...objects)) : '';
    stage.dataset['activeRows'] = String(active.length);
    stage.dataset['arrows'] = String(rows.length);
    stage.dataset['ends'] = String(ends.length);
    stage.dataset['passing'] = String(sides.length);
    // Of rows whose nearest point is no matter of choice, as it is of parallel shapes.
    stage.dataset['leastRoom'] = String(Math.min(Infinity, ...[...ends, ...sides].map((row) => row.room)));
  };

  const drawNow = (): void => {
    scene?.render();
    drawLabels();
    timeline.draw(palette(), time);
  };

  let asked = 0;
  /** With the next frame, and once for all that was asked for until then. */
  const draw = (): void => {
    if (asked !== 0) return;
    asked = requestAnimationFrame(() => {
      asked = 0;
      drawNow();
    });
  };

  const drawJoints = (): void => {
    if (robot === null || trace === null) return;
    const now = trace;
    const bars = joints.querySelectorAll<HTMLElement>('i');
    robot.driven.forEach((joint, i) => {
      const value = now.at(`q${i}`, Math.min(time, now.end));
      const bounded = Number.isFinite(joint.lower) && Number.isFinite(joint.upper);
      const share = bounded ? Math.min(1, Math.max(0, (value - joint.lower) / (joint.upper - joint.lower))) : 0.5;
      const bar = bars[i];
      if (bar === undefined) return;
      bar.style.left = `${100 * share}%`;
      bar.parentElement?.classList.toggle('near', bounded && Math.min(share, 1 - share) < 0.04);
    });
  };

  const last = (): number => Math.max(trace?.end ?? 0, ghost?.trace.end ?? 0);

  const tellLegend = (): void => {
    const c = colours();
    const part = (colour: string, text: string): Node => h('span', { class: 'dotted', style: `--c:${colour}` }, text);
    const t = model.trials;
    replace(legend, part(c.arm, 'robot'), part(c.goal, 'goal: the hand as it must arrive, a ball as large as the tolerance'), part(c.path, 'path of the hand, paler at its begin'),
      part(c.hit, 'touched, or a row that holds the command back'), ghost === null ? null : part(c.ghost, `${t.text('controller', model.row(ghost.trial) ?? -1)} in the same world`));
  };

  const tellTriangles = (): void => { stage.dataset['triangles'] = String(scene?.triangles() ?? 0); };

  const show = (): void => {
    scene?.set(time);
    scrub.value = String(time);
    clock.textContent = words.clock = `${fixed(time, 2)} of ${fixed(last(), 2)} s`;
    if (trace !== null) status.textContent = `Solver: ${statusAt(trace, Math.min(time, trace.end))}; ${plural(Math.round(trace.at('active_rows', Math.min(time, trace.end))), 'active constraint')}.`;
    if (scene !== null) stage.dataset['positionErrorNow'] = String(scene.positionError());
    tellRows();
    drawJoints();
    draw();
  };

  const seek = (t: number): void => {
    time = Math.min(Math.max(0, t), last());
    show();
  };

  const tick = (now: number): void => {
    if (!playing) return;
    // A frame's time is that of its begin, which may lie before start().
    if (before !== null) time += Math.min(0.1, Math.max(0, now - before) / 1000) * rate;
    before = now;
    if (time >= last()) {
      time = last();
      pause();
    }
    show();
    if (playing) frame = requestAnimationFrame(tick);
  };

  const pause = (): void => {
    playing = false;
    cancelAnimationFrame(frame);
    play.textContent = 'Play';
  };

  const start = (): void => {
    if (trace === null || playing) return;
    if (time >= last() - 1e-6) time = 0;
    playing = true;
    before = null;
    play.textContent = 'Pause';
    frame = requestAnimationFrame(tick);
  };

  const toggle = (): void => (playing ? pause() : start());

  /** To the least distance from an object, or to the end. */
  const jump = (to: 'least' | 'end'): void => {
    if (trace === null) return;
    pause();
    const distances = trace.column('least_distance');
    let best = 0;
    for (let i = 1; i < trace.n; ++i) if ((distances[i] ?? Infinity) < (distances[best] ?? Infinity)) best = i;
    seek(to === 'end' ? trace.end : trace.t[best] ?? 0);
  };

  const fileName = (): string => `replay-${current || 'trial'}`;

  /** The moment shown, with its words. */
  const picture = (): HTMLCanvasElement => {
    drawNow();   // the canvas holds a picture only until the frame is shown
    plate.draw(canvas, palette(), colours().hit, words);
    return plate.canvas;
  };

  const savePicture = (): void => {
    picture().toBlob((blob) => { if (blob !== null) downloadBlob(`${fileName()}-${fixed(time, 2)}s.png`, blob); });
  };

  const addFrame = async (film: Film, t: number): Promise<void> => {
    seek(t);
    picture();
    await film.add();
  };

  /** Records the motion from its begin to its end at the chosen speed, 30 frames a second; once more: not. */
  const saveFilm = async (): Promise<void> => {
    if (trace === null || filming !== null) {
      filming = null;
      return;
    }
    if (!canFilm()) {
      asFilm.textContent = 'No WebM here';
      return;
    }
    const [name, of, from] = [fileName(), trace, time];
    pause();
    const film = filming = new Film(picture(), kFps);
    const frames = Math.ceil((last() * kFps) / rate) + 1;
    try {
      await film.begin();
      for (let k = 0; k < frames && filming === film && trace === of; ++k) {
        await addFrame(film, (k * rate) / kFps);
        asFilm.textContent = `Stop at ${integer(Math.round((100 * k) / frames))} %`;
      }
      if (filming === film && trace === of) downloadBlob(`${name}.webm`, new Blob([await film.end() as BlobPart], { type: 'video/webm' }));
      else await film.cancel();
      asFilm.textContent = 'Save WebM';
    } catch {
      asFilm.textContent = 'No WebM here';
    }
    if (filming === film) filming = null;
    if (trace === of) seek(from);
  };

  /** Trials of other controllers in the world of `trial` that can be played, successes first. */
  const rivals = (trial: string): string[] => {
    const t = model.trials;
    const row = model.row(trial);
    if (row === undefined) return [];
    const same = (name: string, i: number): boolean => t.text(name, i) === t.text(name, row);
    const found: number[] = [];
    for (let i = 0; i < t.n; ++i) {
      if (i !== row && same('world_key', i) && same('suite', i) && same('robot', i) && same('mode', i) && model.playable(t.text('trial', i))) found.push(i);
    }
    return found.sort((a, b) => Number(t.success(b)) - Number(t.success(a))).slice(0, 40).map((i) => t.text('trial', i));
  };

  /** As chosen; by itself a success of the page beside a failure. */
  const wantedBeside = (): string => {
    const chosen = state.get('beside');
    const all = rivals(current);
    if (chosen === 'none' || all.includes(chosen)) return chosen === 'none' ? '' : chosen;
    const t = model.trials;
    const first = all[0];
    return model.page.live === undefined && first !== undefined && !t.success(model.row(current) ?? -1) && t.success(model.row(first) ?? -1) ? first : '';
  };

  const fillOthers = (): void => {
    const t = model.trials;
    const all = rivals(current);
    otherBox.hidden = all.length === 0;
    const now = wantedBeside();
    replace(other, h('option', { value: 'none', selected: now === '' }, 'nothing'), ...all.map((trial) => {
      const row = model.row(trial) ?? -1;
      return h('option', { value: trial, selected: trial === now }, `${t.text('controller', row)}${t.text('point', row) === '' ? '' : ` ${t.text('point', row)}`}: ${outcomeName(t.outcome(row))}`);
    }));
  };

  /** Visuals of the robot of a motion; none where the page has none. */
  const lookOf = ({ replay }: Motion): readonly Part[] => {
    let known = looks.get(replay.robot);
    if (known === undefined) looks.set(replay.robot, known = readLook(model.page.looks?.[replay.robot]));
    return known;
  };

  /** Brings the other motion into the scene, or takes it away. */
  const setBeside = async (): Promise<void> => {
    fillOthers();
    const trial = wantedBeside();
    const of = current;
    if ((ghost?.trial ?? '') === trial) return;
    const motion = trial === '' ? null : await model.motion(trial);
    if (of !== current || wantedBeside() !== trial) return;   // another was chosen meanwhile
    putBeside(trial, motion);
    scene?.home();
    show();
  };

  const putBeside = (trial: string, motion: Motion | null): void => {
    ghost = motion === null ? null : { trial, trace: decode(motion.replay) };
    scene?.beside(ghost === null || motion === null ? null : { robot: new Robot(motion.robot), trace: ghost.trace, look: lookOf(motion) });
    timeline.beside(ghost?.trace ?? null);
    scrub.max = String(last());
    stage.dataset['beside'] = ghost?.trial ?? '';
    tellLegend();
  };

  const fillShelf = (): void => {
    const t = model.trials;
    const p = palette();
    const names = listed(model);
    replace(shelf, ...(current === '' || names.includes(current) ? names : [current, ...names]).map((trial) => {
      const row = model.row(trial) ?? 0;
      return h('button', {
        type: 'button', role: 'option', 'aria-selected': trial === current ? 'true' : 'false', click: () => select(trial, true),
      },
        h('span', { class: 'dotted', style: `--c:${outcomeColour(p, t.outcome(row))}` }, outcomeName(t.outcome(row))),
        h('small', null, `${t.text('controller', row)} \u00b7 ${t.text('family', row)} ${integer(t.number('world', row))}`),
        t.text('point', row) === '' ? null : h('small', null, t.text('point', row)),
        t.text('link', row) === '' ? null : h('small', null, `${t.text('link', row)} \u2013 ${t.text('object', row)}`));
    }));
  };

  /** Shows a motion from its start. Throws an Error where samples or robot cannot be read. */
  const present = (trial: string, { replay, robot: resolved, simulated }: Motion): void => {
    const decoded = decode(replay);
    const row = model.row(trial) ?? -1;
    const t = model.trials;
    const key = `${t.text('store', row)}:${replay.robot}`;
    const next = robots.get(key) ?? new Robot(resolved);
    robots.set(key, next);
    scene ??= new ReplayScene(canvas, colours(), draw);
    current = trial;
    sees = disturbed(model.point(row));
    trace = decoded;
    robot = next;
    const look = lookOf({ replay, robot: resolved, simulated });
    shapesBox.hidden = look.length === 0;
    scene.follow = follow.checked;
    scene.render();
    scene.show(next, replay.world as WorldJson, decoded, { link: t.text('link', row), object: t.text('object', row) },
      collisionParameters(model.point(row)?.parameters), model.point(row)?.success_position_m ?? 0, look);
    const point = model.point(row);
    timeline.show(decoded, point === undefined ? null : { position: point.success_position_m, rotation: point.success_orientation_rad });
    ghost = null;
    const twin = wantedBeside();
    const embedded = model.embedded(twin);
    putBeside(twin, embedded === undefined ? null : { replay: embedded, robot: model.page.robots[embedded.robot], simulated: false });
    if (ghost !== null) scene.home();
    fillOthers();
    const outcome = t.outcome(row);
    const hit = t.text('link', row);
    replace(caption,
      h('span', { class: 'chip', style: `--c:${outcomeColour(palette(), outcome)}` }, outcomeName(outcome)), ' ',
      h('b', null, t.text('controller', row)), ` ${t.text('point', row)} \u00b7 ${t.text('family', row)} world ${integer(t.number('world', row))}`,
      hit === '' ? (t.text('reason', row) === '' ? '' : ` \u00b7 ${t.text('reason', row)}`) : ` \u00b7 ${hit} against ${t.text('object', row)}`,
      disturbed(model.point(row)) === '' ? '' : ` \u00b7 disturbed: ${disturbed(model.point(row))}`,
      simulated ? ' \u00b7 simulated again for this view' : '');
    replace(joints, ...next.driven.map((joint) => h('div', null, h('span', null, joint.name), h('div', { class: 'rail' }, h('i')))));
    const [chip, ...rest] = caption.childNodes;
    words = { outcome: chip?.textContent ?? '', colour: outcomeColour(palette(), outcome), caption: rest.map((node) => node.textContent).join('').trim(), clock: '', labels: [] };
    time = 0;
    show();
    fillShelf();
    stage.dataset['trial'] = trial;
    tellTriangles();
    stage.dataset['positionError'] = String(scene.positionError());
  };

  const load = async (trial: string, thenPlay: boolean): Promise<void> => {
    if (trial === current) {
      if (thenPlay && !playing) start();
      return;
    }
    wanted = trial;
    pause();
    if (model.page.live !== undefined) replace(caption, 'Reading the motion\u2026');
    const motion = await model.motion(trial);
    if (wanted !== trial) return;   // another was chosen meanwhile
    present(trial, motion);
    if (thenPlay) start();
  };

  /** The moment shown, or the first motion of the page, as pictures. */
  const still = (): Node | null => {
    const first = listed(model)[0] ?? '';
    const replay = model.embedded(first);
    try {
      if (current === '' && replay !== undefined) present(first, { replay, robot: model.page.robots[replay.robot], simulated: false });
    } catch {
      return null;   // the caption on the screen says why
    }
    if (current === '') return null;
    drawNow();
    return h('div', null, h('p', null, ...[...caption.childNodes].map((node) => node.cloneNode(true)), ` \u00b7 at ${fixed(time, 2)} s`),
      h('img', { src: canvas.toDataURL('image/png'), alt: 'The moment shown in the replay' }), h('img', { src: lines.toDataURL('image/png'), alt: 'The motion\u2019s time line' }));
  };

  const safely = (trial: string, thenPlay: boolean): void => {
    load(trial, thenPlay).catch((error: unknown) => {
      if (wanted !== trial) return;
      replace(caption, `This trial cannot be shown here: ${error instanceof Error ? error.message : String(error)}. `, h('code', null, command(model, trial)));
    });
  };

  onSelect((trial, thenPlay) => {
    if (!model.playable(trial)) return;
    if (model.page.live !== undefined && !thenPlay) return;   // walking through the table asks for nothing
    if (thenPlay) document.getElementById('replay')?.scrollIntoView();
    safely(trial, thenPlay);
  });
  const besideSafely = (): void => {
    setBeside().catch((error: unknown) => { near.textContent = `The other motion cannot be shown: ${error instanceof Error ? error.message : String(error)}.`; });
  };
  state.listen(['beside'], () => { if (current !== '') besideSafely(); });
  onTheme(() => { scene?.setColours(colours()); fillShelf(); tellLegend(); show(); });
  const element = h('div', { class: 'replay' },
    h('div', { class: 'replay-main' },
      stage, paper,
      h('div', { class: 'transport' }, play, scrub, clock, speed, h('label', null, follow, ' follow'), shapesBox, home),
      h('div', { class: 'transport more' }, otherBox, closest, stopped, asPicture, asFilm),
      legend,
      lines, status, near),
    h('aside', null, h('h3', null, 'To play'), h('p', { class: 'note' }, shelfNote(model)), shelf,
      h('h3', null, 'Joints within their limits'), joints));
  element.addEventListener('keydown', (event) => {
    if (event.target instanceof HTMLInputElement || event.target instanceof HTMLSelectElement || event.target instanceof HTMLButtonElement) return;
    const move = { ArrowLeft: -0.1, ArrowRight: 0.1 }[event.key];
    if (event.key === ' ') toggle();
    else if (move !== undefined) { pause(); seek(time + move); }
    else return;
    event.preventDefault();
  });
  fillShelf();
  onPaper(paper, still);
  onView(fillShelf);
  whenSeen(element, () => {
    const asked = state.get('trial');
    if (current === '' && wanted === '') safely(model.playable(asked) ? asked : listed(model)[0] ?? '', false);
    new ResizeObserver(() => draw()).observe(stage);
  });
  const reel = (fps: number, speed: number): Reel => {
    let film: Film | null = null;
    return {
      begin: async () => {
        if (!canFilm()) throw new Error('this browser encodes no video');
        const first = listed(model)[0] ?? '';
        present(first, await model.motion(first));
        film = new Film(picture(), fps);
        await film.begin();
        return last();
      },
      add: async (k) => { if (film !== null) await addFrame(film, (k * speed) / fps); },
      end: async () => { if (film === null) throw new Error('no film has begun'); return film.end(); },
    };
  };
  return { element, reel };
}
