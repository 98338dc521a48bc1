// SPDX-License-Identifier: GPL-3.0-or-later
// The tool path in space, moved through by the same timeline as the bed.
import { effect, useSignal } from '@preact/signals';
import { useEffect, useRef } from 'preact/hooks';
import { detailFor } from '../../../machines/path_detail';
import type { PathDetail, ToolPath } from '../../../machines/toolpath';
import { partAt, placeAt } from '../../../machines/toolpath';
import type { Insets, MeshData, Vec3, Viewpoint } from '../../../view';
import { Viewport } from '../../../view';
import { narrow } from '../../../shared/panels/narrow';
import { shadingOf } from '../../../shared/panels/shaded_mesh';
import { readMesh } from '../../../shared/session/read_mesh';
import { timeShown } from '../panel/job_bar';
import type { MachinesSession } from '../machines_session';
import type { CarvedSurface } from '../make_plan';
import { blockEdges, blockOf, boardUnder, movedTo, pathCurves, toolMesh } from './path_scene';

/** From the front, a little from the left and from above; z is up. */
const viewpoint: Viewpoint = {
  projection: 'perspective',
  direction: [0.35, 0.8, -0.75],
  up: [0, 0, 1],
  targetMm: [0, 0, 0],
  distanceMm: 900,
  fieldOfViewDeg: 20,
};
/** What floats stays off the path: tools above, the timeline below. */
const insets = (): Insets =>
  narrow() ? { left: 8, top: 66, right: 8, bottom: 110 } : { left: 24, top: 66, right: 24, bottom: 120 };

export interface PathViewProps {
  readonly session: MachinesSession;
  /** Over the carved surface; where there is none they are shown in any case. */
  readonly showPaths: boolean;
  readonly showTravel: boolean;
}

export function PathView({ session, showPaths, showTravel }: PathViewProps) {
  const container = useRef<HTMLDivElement>(null);
  const scene = useRef<PathScene | null>(null);
  const plan = session.plan.value;
  useEffect(() => {
    if (container.current === null) return undefined;
    const made = new PathScene(container.current, session);
    scene.current = made;
    const stop = [
      effect(() => made.follow(timeShown(session))),
      effect(() => made.viewport.setResting(session.activity.value.kind !== 'idle')),
    ];
    return () => {
      for (const end of stop) end();
      scene.current = null;
      made.viewport.dispose();
    };
  }, [session]);
  const carved = useSignal<Carved | null>(null);
  const surface = plan?.carved ?? null;
  useEffect(() => {
    if (surface === null) return undefined;
    let wanted = true;
    void carvedMesh(session, surface).then(
      (mesh) => {
        if (wanted) carved.value = { of: surface, mesh };
      },
      () => undefined, // the tool paths stay
    );
    return () => void (wanted = false);
  }, [session, surface]);
  const mesh = surface !== null && carved.value?.of === surface ? carved.value.mesh : null;
  useEffect(
    () => scene.current?.show(plan?.toolPath ?? null, { carved: mesh, showPaths, showTravel }),
    [session, plan, mesh, showPaths, showTravel],
  );
  return (
    <div class="path-view">
      <div ref={container} class="viewport" />
    </div>
  );
}

interface Carved {
  readonly of: CarvedSurface;
  readonly mesh: MeshData;
}

async function carvedMesh(
  { services }: MachinesSession,
  { blob, offset_mm }: CarvedSurface,
): Promise<MeshData> {
  const mesh = await readMesh(await services.projects.blobs.read(blob));
  return { positions: movedTo(mesh.positions, offset_mm), indices: mesh.indices, ...shadingOf(mesh) };
}

interface Shown {
  readonly carved: MeshData | null;
  readonly showPaths: boolean;
  readonly showTravel: boolean;
}

class PathScene {
  readonly viewport: Viewport;
  readonly #session: MachinesSession;
  #toolPath: ToolPath | null = null;
  #detail: PathDetail | null = null;
  #shown: Shown = { carved: null, showPaths: false, showTravel: false };
  #tool: { readonly mesh: MeshData; readonly layer: string } | null = null;

  constructor(container: HTMLElement, session: MachinesSession) {
    this.#session = session;
    this.viewport = new Viewport(container, {
      mode: 'original',
      freeRectangle: insets(),
      label: 'Tool path',
      uprightTurn: true,
      dimensions: false,
      ground: true,
      onViewpointChange: () => this.#refine(),
    });
    this.viewport.setViewpoint(viewpoint);
    this.viewport.lookFromViewpoint(false);
  }

  show(toolPath: ToolPath | null, shown: Shown): void {
    const block = toolPath && blockOf(toolPath);
    const other = this.#toolPath !== toolPath;
    const carved = other || this.#shown.carved !== shown.carved;
    this.#toolPath = toolPath;
    this.#shown = shown;
    if (other) this.#tool = null;
    if (carved) this.viewport.setOriginal(shown.carved ?? (block ? boardUnder(block) : null));
    this.#detail = this.#wanted();
    this.#draw();
    this.follow(timeShown(this.#session));
  }

  /** The board and the lines as far as they have been run, the tool where it is. */
  follow(time_s: number | null): void {
    const toolPath = this.#toolPath;
    this.viewport.setReach(time_s);
    const place = toolPath && time_s !== null ? placeAt(toolPath, time_s) : null;
    if (toolPath === null || place === null || time_s === null) {
      this.viewport.setMarkers([]);
      if (this.#tool) this.viewport.setFixtures([]);
      this.#tool = null;
      return;
    }
    const at: Vec3 = [place.x_mm, place.y_mm, place.z_mm];
    this.viewport.setMarkers([{ id: 'head', positionMm: at, kind: 'live' }]);
    if (this.#session.operationName === 'mill-job') this.#moveTool(at, partAt(toolPath, time_s)?.layer ?? '');
  }

  #moveTool(at: Vec3, layer: string): void {
    // While it travels the tool is the one of the work before.
    const known = this.#tool;
    if (known && (layer === known.layer || layer === '')) {
      this.viewport.moveFixture('tool', movedTo(known.mesh.positions, at));
      return;
    }
    const number = (name: string) => Number(this.#session.value(name) ?? 0);
    const rough = layer !== 'finish';
    const mesh = toolMesh({
      shape: String(this.#session.value(rough ? 'rough_tool' : 'tool')),
      diameter_mm: number(rough ? 'rough_diameter_mm' : 'diameter_mm'),
      v_angle_degrees: number('v_angle_degrees'),
      v_tip_mm: number('v_tip_mm'),
    });
    this.#tool = { mesh, layer };
    const there = { ...mesh, positions: movedTo(mesh.positions, at) };
    this.viewport.setFixtures([{ id: 'tool', mesh: there, parts: ['original'], framed: false }]);
  }

  /** Nearer, more points are needed. */
  #refine(): void {
    const wanted = this.#wanted();
    if (wanted === this.#detail) return;
    this.#detail = wanted;
    this.#draw();
  }

  #wanted(): PathDetail | null {
    const toolPath = this.#toolPath;
    const block = toolPath && blockOf(toolPath);
    if (!toolPath || !block || !toolPath.details?.length) return null;
    const middle = [0, 1, 2].map((k) => ((block[0][k] ?? 0) + (block[1][k] ?? 0)) / 2) as unknown as Vec3;
    const centre = this.viewport.project(middle);
    let pixels = 0;
    for (const k of [0, 1, 2]) {
      const beside = this.viewport.project(middle.map((v, i) => (i === k ? v + 1 : v)) as unknown as Vec3);
      if (centre && beside)
        pixels = Math.max(pixels, Math.hypot(beside.xPx - centre.xPx, beside.yPx - centre.yPx));
    }
    return detailFor(toolPath, pixels > 0 ? 1 / pixels : 1, this.viewport.linePieces);
  }

  #draw(): void {
    const toolPath = this.#toolPath;
    const block = toolPath && blockOf(toolPath);
    if (!toolPath || !block) {
      this.viewport.setCurves([]);
      return;
    }
    const most = this.viewport.linePieces;
    const { carved, showPaths, showTravel } = this.#shown;
    const paths = carved && !showPaths ? [] : pathCurves(toolPath, this.#detail, showTravel, most);
    this.viewport.setCurves([blockEdges(block), ...paths]);
  }
}
