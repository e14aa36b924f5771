// A motion as WebM: frames at exact times, however long each takes to draw.

import { BufferTarget, CanvasSource, Output, QUALITY_HIGH, WebMOutputFormat } from 'mediabunny';

export class Film {
  private readonly target = new BufferTarget();
  private readonly output = new Output({ format: new WebMOutputFormat(), target: this.target });
  private readonly source: CanvasSource;
  private frames = 0;

  /** Of what the canvas shows at each add(); its size must stay. */
  constructor(canvas: HTMLCanvasElement, private readonly fps: number) {
    this.source = new CanvasSource(canvas, { codec: 'vp9', bitrate: QUALITY_HIGH, keyFrameInterval: 2, latencyMode: 'quality' });
    this.output.addVideoTrack(this.source, { frameRate: fps });
  }

  async begin(): Promise<void> {
    await this.output.start();
  }

  /** The next frame. Resolves when there is room for another. */
  async add(): Promise<void> {
    await this.source.add(this.frames++ / this.fps, 1 / this.fps);
  }

  async end(): Promise<Uint8Array> {
    await this.output.finalize();
    if (this.target.buffer === null) throw new Error('the video was not written');
    return new Uint8Array(this.target.buffer);
  }

  async cancel(): Promise<void> {
    await this.output.cancel();
  }
}
