// The replay section: choose a trial, play it, scrub, look around.

import { disturbed } from '../conditions';
import { outcomeName, type Model, type Motion } from '../data';
import { button, dotted, h, replace } from '../dom';
import { fixed, integer, plural, said } from '../format';
import { goToSection } from '../go_to';
import { drawLater, isNear, whenSeen } from '../draw_order';
import { onPaper } from '../paper';
import { onSelect } from '../select';
import { command } from '../sections/trials';
import * as state from '../state';
import { outcomeColour, palette } from '../theme';
import { kView } from '../view';
import { listed, MotionList, motionsNote, SecondMotion } from './motions';
import { readMap } from './map';
import { Joints } from './joints';
import { readLook, type Skin } from './look';
import { looksAhead, planSentence } from './plan';
import { drawCaptioned, type Words } from './captioned_picture';
import { Playback } from './playback';
import { Robot } from './robot';
import { readRows, RowWords } from './rows';
import { filmButton, pictureButton, type Shown } from './saving';
import { reachedTimes, ReplayScene, type Layer, type Moved, type WorldJson } from './scene';
import { signals, statusAt, Timeline } from './timeline';
import { decode, type Trace } from './trace';

const kSpeeds = [0.25, 0.5, 1, 2, 4] as const;
/** Switches of what a motion may have beside the robot and the objects. */
const kLayers: readonly { layer: Layer; name: string; title: string; on: boolean; legend: string }[] = [
  { layer: 'occupied', name: 'occupied', title: 'Boxes of the map\u2019s occupied cells, from which the controller keeps away', on: true, legend: 'occupied cells of the map' },
  { layer: 'unseen', name: 'unseen', title: 'Boxes of cells near the robot that no sensor has seen: the controller stops in front of them', on: true, legend: 'unseen cells near the robot' },
  { layer: 'fields', name: 'sensor fields', title: 'What each sensor can see, to its range', on: false, legend: 'what a sensor can see, to its range' },
];
/** An arrow key moves the time by this much [s]. */
const kStep = 0.1;

function nothingToPlay(model: Model): HTMLElement {
  return h('div', { class: 'empty' },
    h('p', null, 'The store keeps no samples of these trials, so none can be played here. A trial is simulated again, bit for bit, by'),
    h('p', { class: 'command' }, h('code', null, command(model, model.trials.text('trial', 0)))));
}

export function player(model: Model): HTMLElement {
  if (listed(model).length === 0) return nothingToPlay(model);
  let scene: ReplayScene | null = null;
  let trace: Trace | null = null;
  let robot: Robot | null = null;
  let current = '';
  let ghost = '';   // trial of the motion beside it
  let hasRows = false;
  let sees = '';   // what of the controller's senses is disturbed
  let wanted = '';
  const looks = new Map<string, readonly Skin[]>();
  let words: Words = { outcome: '', colour: '', caption: '', clock: '', labels: [] };
  const captioned = document.createElement('canvas');
  const motions = new MotionList(model);
  const beside = new SecondMotion(model);
  const rowWords = new RowWords();
  const joints = new Joints();

  const canvas = h('canvas', { class: 'stage', tabindex: 0, 'aria-label': 'Replay in 3-D; drag to turn; after a click the wheel comes closer' });
  const lines = h('canvas', { class: 'timeline', 'aria-hidden': 'true' });
  const signal = h('select', { 'aria-label': 'Signal', change: () => { chooseSignal(); draw(); } });
  const play = button('Play', () => toggle(), 'play');
  const scrub = h('input', { type: 'range', min: 0, max: 1, step: 'any', value: 0, 'aria-label': 'Time', input: () => moveTo(Number(scrub.value)) });
  const clock = h('output', { class: 'clock' });
  const speed = h('select', { 'aria-label': 'Speed', change: () => { playback.rate = Number(speed.value); } }, ...kSpeeds.map((s) => h('option', { value: s, selected: s === 1 }, `${s}\u00d7`)));
  const follow = h('input', { type: 'checkbox', change: () => { if (scene !== null) scene.follow = follow.checked; } });
  const home = button('Reset view', () => { scene?.home(); scene?.set(playback.time); draw(); });
  const caption = h('div', { class: 'replay-caption' });
  const status = h('p', { class: 'note' });
  const ahead = h('p', { class: 'note plan-now' });
  const closest = button('Closest approach', () => jump('least'));
  const stopped = button('Why it stopped', () => jump('end'));
  const shapes = h('input', { type: 'checkbox', change: () => { scene?.setShapes(shapes.checked); tellTriangles(); show(); } });
  const shapesBox = h('label', { hidden: true, title: 'What counts in collisions, in place of what the robot looks like' }, shapes, ' shapes');
  const layers = kLayers.map(({ layer, name, title, on, legend: text }) => {
    const input = h('input', { type: 'checkbox', checked: on, change: () => { scene?.showLayer(layer, input.checked); tellLegend(); draw(); } });
    return { layer, text, input, label: h('label', { hidden: true, title }, input, ` ${name}`) };
  });
  const switches = h('div', { class: 'transport more', hidden: true }, ...layers.map(({ label }) => label));
  const legend = h('p', { class: 'replay-legend' });
  const stage = h('div', { class: 'stage-box' }, canvas, rowWords.labels, caption);
  rowWords.keepClear(stage, caption, () => { if (current !== '') draw(); });

  const show = (): void => {
    const { time } = playback;
    scene?.set(time);
    scrub.value = String(time);
    clock.textContent = words.clock = `${fixed(time, 2)} of ${fixed(timeline.end, 2)} s`;
    if (trace !== null && robot !== null) {
      const now = Math.min(time, trace.end);
      status.textContent = `Solver: ${statusAt(trace, now)}; ${plural(Math.round(trace.at('active_rows', now)), 'active constraint')}.`;
      joints.draw(robot, trace, now);
      ahead.textContent = planSentence(trace, now);
      ahead.hidden = ahead.textContent === '';
    }
    if (scene !== null) {
      Object.assign(stage.dataset, { positionErrorNow: scene.positionError(), planned: scene.planned.length, ...scene.boxes });
    }
    rowWords.tell(scene?.rows ?? [], hasRows, sees, stage);
    draw();
  };
  const playback = new Playback(() => timeline.end, show, (running) => { play.textContent = running ? 'Pause' : 'Play'; });
  const start = (): void => { if (trace !== null) playback.start(); };
  const toggle = (): void => { if (trace !== null) playback.toggle(); };
  const moveTo = (t: number): void => {
    playback.pause();
    playback.seek(t);
  };
  const timeline = new Timeline(lines, moveTo);
  const chooseSignal = (): void => {
    const [option] = signal.selectedOptions;
    timeline.signal = option === undefined || option.value === '' ? null : { column: option.value, name: option.text };
  };
  /** Offers the signals of a motion; the chosen one stays where it has that, too. */
  const offerSignals = (of: Trace, joints: readonly string[]): void => {
    const now = timeline.signal?.column;
    replace(signal, h('option', { value: '' }, 'no other'), ...signals(of, joints).map(([column, name]) => h('option', { value: column, selected: column === now }, name)));
    chooseSignal();
  };

  let asked = 0;
  const drawNow = (): void => {
    cancelAnimationFrame(asked);
    asked = 0;
    scene?.render();
    words.labels = rowWords.label(scene);
    timeline.draw(palette(), playback.time);
  };
  const ask = (): void => {
    if (asked === 0) asked = requestAnimationFrame(drawNow);
  };
  /** With the next frame, and once for all that was asked for until then. A scene far from the window is drawn when it comes near: pictures that nobody sees would pile up, each waiting for the one before. */
  const draw = (): void => {
    if (isNear(stage)) ask();
    else whenSeen(stage, ask);
  };

  const tellLegend = (): void => {
    const c = palette().scene;
    const t = model.trials;
    replace(legend, dotted(c.arm, 'robot'), dotted(c.goal, 'goal: the hand as it must arrive, a ball as large as the tolerance'), dotted(c.path, 'path of the hand, paler at its begin'),
      dotted(c.hit, 'touched, or a row that holds the command back'),
      ...layers.filter(({ input, label }) => input.checked && !label.hidden).map(({ layer, text }) => dotted(c[layer], text)),
      trace !== null && looksAhead(trace) ? dotted(c.plan, 'where the base is to go: the path that it follows, or a detour') : null, ghost === '' ? null : dotted(c.ghost, `${['controller', 'point'].map((name) => t.text(name, model.row(ghost) ?? -1)).join(' ').trim()} in the same world`));
  };

  const tellTriangles = (): void => { stage.dataset['triangles'] = String(scene?.triangles() ?? 0); };

  /** To the least distance from an object, or to the end. */
  const jump = (to: 'least' | 'end'): void => {
    if (trace === null) return;
    const distances = trace.column('least_distance');
    const best = distances.reduce((least, distance, i) => (distance < (distances[least] ?? Infinity) ? i : least), 0);
    moveTo(to === 'end' ? trace.end : trace.t[best] ?? 0);
  };

  const shown: Shown = {
    name: () => (current === '' ? '' : `replay-${current}`), playback,
    picture: () => {
      drawNow();   // the canvas holds a picture only until the frame is shown
      drawCaptioned(captioned, canvas, palette(), words);
      return captioned;
    },
  };

  /** Visuals of the robot of a motion; none where the page has none. */
  const lookOf = ({ replay }: Motion): readonly Skin[] => {
    let known = looks.get(replay.robot);
    if (known === undefined) looks.set(replay.robot, known = readLook(model.page.looks?.[replay.robot]));
    return known;
  };

  /** Throws an Error where samples or robot cannot be read. */
  const movedOf = (motion: Motion): Moved => ({ robot: new Robot(motion.robot), trace: decode(motion.replay), look: lookOf(motion) });

  const putBeside = (trial: string, motion: Motion | null): void => {
    ghost = motion === null ? '' : trial;
    const moved = motion === null ? null : movedOf(motion);
    scene?.beside(moved);
    timeline.ghost = moved?.trace ?? null;
    scrub.max = String(timeline.end);
    stage.dataset['beside'] = ghost;
    tellLegend();
  };

  /** Brings the other motion into the scene, or takes it away. */
  const setBeside = async (): Promise<void> => {
    beside.fill(current);
    const trial = beside.wanted(current);
    const of = current;
    if (ghost === trial) return;
    const motion = trial === '' ? null : await model.motion(trial);
    if (of !== current || beside.wanted(current) !== trial) return;   // another was chosen meanwhile
    putBeside(trial, motion);
    scene?.home();
    show();
  };

  /** Caption of the motion, over the scene and in saved pictures. */
  const tellCaption = (row: number, simulated: boolean): void => {
    const t = model.trials;
    const [outcome, hit, senses] = [t.outcome(row), t.text('link', row), disturbed(model.point(row))];
    const colour = outcomeColour(palette(), outcome);
    replace(caption,
      h('span', { class: 'chip', style: `--c:${colour}` }, outcomeName(outcome)), ' ',
      h('b', null, t.text('controller', row)), ` ${t.text('point', row)} \u00b7 ${t.text('family', row)} world ${integer(t.number('world', row))}`,
      hit === '' ? (t.text('reason', row) === '' ? '' : ` \u00b7 ${t.text('reason', row)}`) : ` \u00b7 ${hit} against ${t.text('object', row)}`,
      senses === '' ? '' : ` \u00b7 disturbed: ${senses}`,
      simulated ? ' \u00b7 simulated again for this view' : '');
    const [chip, ...rest] = caption.childNodes;
    words = { outcome: chip?.textContent ?? '', colour, caption: rest.map((node) => node.textContent).join('').trim(), clock: '', labels: [] };
  };

  /** Shows a motion from its start. */
  const present = (trial: string, motion: Motion): void => {
    const moved = movedOf(motion);
    const row = model.row(trial) ?? -1;
    const t = model.trials;
    const point = model.point(row);
    scene ??= new ReplayScene(canvas, draw);
    current = trial;
    sees = disturbed(point);
    ({ trace, robot } = moved);
    shapesBox.hidden = moved.look.length === 0;
    const rows = readRows(motion.replay);
    hasRows = rows !== null;
    scene.follow = follow.checked;
    scene.resize();
    const world = motion.replay.world as WorldJson;
    const map = readMap(motion.replay);
    for (const { layer, input, label } of layers) {
      label.hidden = layer === 'fields' ? moved.robot.sensors.length === 0 : map === null || map.boxes.every(({ cells }) => cells !== layer);
      scene.showLayer(layer, input.checked);
    }
    switches.hidden = layers.every(({ label }) => label.hidden);
    scene.show({
      ...moved, world, reached: reachedTimes(t.text('goals', row), world, point?.success_dwell_s ?? 0), rows: rows ?? [], map,
      hit: { link: t.text('link', row), object: t.text('object', row) }, tolerance: point?.success_position_m ?? 0,
    });
    timeline.show(moved.trace, point === undefined ? null : { position: point.success_position_m, rotation: point.success_orientation_rad });
    const twin = beside.wanted(current);
    const besides = model.embedded(twin) ?? null;
    putBeside(twin, besides);
    if (besides !== null) scene.home();
    beside.fill(current);
    tellCaption(row, motion.simulated);
    joints.show(moved.robot);
    offerSignals(moved.trace, moved.robot.driven.map(({ name }) => name));
    playback.time = 0;
    show();
    motions.fill(current);
    stage.dataset['trial'] = trial;
    tellTriangles();
    stage.dataset['positionError'] = String(scene.positionError());
  };

  const load = async (trial: string, thenPlay: boolean): Promise<void> => {
    if (trial === current) {
      if (thenPlay) start();
      return;
    }
    wanted = trial;
    playback.pause();
    if (model.page.live !== undefined) replace(caption, 'Reading the motion\u2026');
    try {
      const motion = await model.motion(trial);
      if (wanted !== trial) return;   // another was chosen meanwhile
      present(trial, motion);
      if (thenPlay) start();
    } catch (error) {
      if (wanted === trial) replace(caption, `This trial cannot be shown here: ${said(error)}. `, h('code', null, command(model, trial)));
    }
  };

  /** The moment shown, as pictures; where the reader has moved nothing, that at which the motion stopped. */
  const still = (): Node | null => {
    const first = listed(model)[0] ?? '';
    const motion = model.embedded(first);
    try {
      if (current === '' && motion !== undefined) present(first, motion);
    } catch {
      return null;   // the caption on the screen says why
    }
    if (current === '') return null;
    const untouched = playback.time === 0;
    if (untouched) playback.seek(trace?.end ?? 0);
    drawNow();
    const pictures = h('div', null, h('p', null, ...[...caption.childNodes].map((node) => node.cloneNode(true)), ` \u00b7 at ${fixed(playback.time, 2)} s`),
      h('img', { src: canvas.toDataURL('image/png'), alt: 'The moment shown in the replay' }), h('img', { src: lines.toDataURL('image/png'), alt: 'The motion\u2019s time line' }));
    if (untouched) playback.seek(0);
    return pictures;
  };

  onSelect((trial, thenPlay) => {
    if (!model.playable(trial)) return;
    if (model.page.live !== undefined && !thenPlay) return;   // walking through the table asks for nothing
    if (thenPlay) goToSection('replay');
    void load(trial, thenPlay);
  });
  state.listen(['beside'], () => {
    if (current !== '') setBeside().catch((error: unknown) => { rowWords.sentence.textContent = `The other motion cannot be shown: ${said(error)}.`; });
  });
  state.listen(['theme'], () => { scene?.build(); motions.fill(current); tellLegend(); show(); });
  const element = h('div', { class: 'replay' },
    h('div', { class: 'replay-main' },
      stage, onPaper(still),
      h('div', { class: 'transport' }, play, scrub, clock, speed, h('label', null, follow, ' follow'), shapesBox, home),
      h('div', { class: 'transport more' }, beside.element, closest, stopped, pictureButton(shown), filmButton(shown)),
      switches, legend,
      h('label', { class: 'choice' }, h('span', null, 'signal below'), signal), lines, status, ahead, rowWords.sentence),
    h('aside', null, h('h3', null, 'To play'), h('p', { class: 'note' }, motionsNote(model)), motions.element,
      h('h3', null, 'Joints within their limits'), joints.element));
  element.addEventListener('keydown', (event) => {
    if (event.target instanceof HTMLInputElement || event.target instanceof HTMLSelectElement || event.target instanceof HTMLButtonElement) return;
    const move = { ArrowLeft: -kStep, ArrowRight: kStep }[event.key];
    if (event.key === ' ') toggle();
    else if (move !== undefined) moveTo(playback.time + move);
    else return;
    event.preventDefault();
  });
  motions.fill(current);
  state.listen(kView, () => motions.fill(current));
  // A motion of the page itself is shown like a figure; one of the server, which may have to simulate it, when it is looked at.
  (model.page.live === undefined ? drawLater : whenSeen)(element, () => {
    const ofAddress = state.get('trial');
    if (current === '' && wanted === '') void load(model.playable(ofAddress) ? ofAddress : listed(model)[0] ?? '', false);
    new ResizeObserver(() => draw()).observe(stage);
  });
  return element;
}
