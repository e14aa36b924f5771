// A motion as WebM: frames at exact times, however long each takes to draw.

import { BufferTarget, CanvasSource, Output, QUALITY_HIGH, WebMOutputFormat } from 'mediabunny';

/** Films what `draw` puts onto the canvas, whose size must stay, for each of so many frames; null where it is no longer `wanted`. */
export async function film(canvas: HTMLCanvasElement, frames: number, fps: number, draw: (frame: number) => void, wanted: () => boolean): Promise<Blob | null> {
  const target = new BufferTarget();
  const output = new Output({ format: new WebMOutputFormat(), target });
  const source = new CanvasSource(canvas, { codec: 'vp9', bitrate: QUALITY_HIGH, keyFrameInterval: 2, latencyMode: 'quality' });
  output.addVideoTrack(source, { frameRate: fps });
  await output.start();
  for (let k = 0; k < frames && wanted(); ++k) {
    draw(k);
    await source.add(k / fps, 1 / fps);   // resolves when there is room for another
  }
  await (wanted() ? output.finalize() : output.cancel());
  return wanted() && target.buffer !== null ? new Blob([target.buffer], { type: 'video/webm' }) : null;
}
