// SPDX-License-Identifier: GPL-3.0-or-later
// What the view of the pillar forest does: changes the scene, has it planned at once and made when asked.
import { computed, effect, signal, untracked } from '@preact/signals';
import type { JobError, Operation, Report } from '../../../jobs/contract';
import { asJobError, findOperation } from '../../../jobs/contract';
import { readSolid } from '../../../jobs/mesh_reader';
import type { CraftModel } from '../../../shared/session/craft_document';
import { inForce, modelsElsewhere, nameProject, titleOf } from '../../../shared/session/craft_document';
import type { Measured } from '../../../shared/session/estimate';
import { expectedTimes } from '../../../shared/session/estimate';
import { outputOf, solveInFull } from '../../../shared/session/full_solve';
import { bytesOf } from '../../../shared/session/import_model';
import { figure } from '../../../shared/session/report';
import type { BusyOptions, Change } from '../../../shared/session/room_session';
import { RoomSession } from '../../../shared/session/room_session';
import type { Services } from '../../../shared/session/services';
import type { MeshData } from '../../../view';
import type { ForestDocument, ForestResult } from './forest_document';
import { forest, forestOperation, resultOf, subjectOf } from './forest_document';
import { LivePlan } from './live_plan';
import type { Chosen, Pillar, Scene, Source } from './scene';
import { changeViewpoint, readScene, sceneBytes, withSource } from './scene';

const openKey = 'formwright.relief.forest';
const projectTitle = 'Pillar forest';

interface Opened {
  readonly project: string;
  readonly open: boolean;
}

function readOpened(): Opened | null {
  const text = sessionStorage.getItem(openKey);
  return text === null ? null : (JSON.parse(text) as Opened);
}

/** "model", "model_2", ... */
const isModelInput = (where: string): boolean => /^model(_\d+)?$/.test(where);
const isSceneFile = ({ name }: File): boolean => name.toLowerCase().endsWith('.json');

export class ForestSession extends RoomSession<ForestDocument> {
  readonly operationName = forestOperation;
  /** Making one of them later would take as long as making all. */
  readonly wantedOutputs = [
    'forest.glb',
    'pictures.zip',
    'overview.png',
    'pillars.zip',
    'pillars.3mf',
    'floor_plan.svg',
    'floor_plan.dxf',
    'scene.json',
    'plan.json',
  ];
  readonly failedTitle = 'Could not make the forest';
  readonly document = computed(() => forest.of(this.services.projects.document.value));
  readonly operation = computed<Operation | null>(() => {
    const catalog = this.services.catalog.value;
    return catalog === null ? null : (findOperation(catalog, this.operationName) ?? null);
  });
  readonly asked = computed(() => this.document.value.parameters);
  readonly hasWork = computed(() => {
    const { scene, parameters, results } = this.document.value;
    return scene !== null || results.length > 0 || Object.keys(parameters).length > 0;
  });
  /** In which project it was last opened or left. */
  readonly #opened = signal<Opened | null>(readOpened());
  /** The room shows it in the place of the relief. A reload finds it as it was left; a project that has nothing but a forest shows it. */
  readonly open = computed(() => {
    const { id, crafts } = this.services.projects.document.value;
    const opened = this.#opened.value;
    if (opened?.project === id) return opened.open;
    return crafts[forest.craft] !== undefined && crafts['relief'] === undefined;
  });
  readonly chosen = signal<Chosen | null>(null);
  readonly plan = new LivePlan(this);
  /** The file of the scene in force. */
  readonly #kept = signal<{ readonly scene: Scene; readonly hash: string } | null>(null);
  readonly subject = computed(() => {
    const { scene, models } = this.document.value;
    if (scene === null) return subjectOf(null, models);
    const kept = this.#kept.value;
    return kept?.scene === scene ? subjectOf(kept.hash, models) : null;
  });
  readonly result = this.unlessLost(
    computed<ForestResult | null>(() => resultOf(this.document.value, this.subject.value)),
  );
  /** As drawn: with the pillars that a layout made; what is set by hand is there at once. */
  readonly scene = computed<Scene | null>(() => {
    const { scene, parameters } = this.document.value;
    const operation = this.operation.value;
    if (scene && operation && inForce(operation, parameters, 'layout') === 'scene') return scene;
    return this.plan.planned.value?.made ?? scene;
  });
  /** What is looked at: made of the scene in force, or the last one that was made. */
  readonly shown = computed<ForestResult | null>(() => {
    const own = this.result.value as ForestResult | null;
    return own ?? this.document.value.results[0] ?? null;
  });
  readonly shownScene = signal<Scene | null>(null);
  /** Its pillars where they stand. */
  readonly solid = signal<{ readonly mesh: MeshData; readonly of: string } | null>(null);
  /** Models of the project's other rooms. */
  readonly elsewhere = computed(() => modelsElsewhere(this.services.projects.document.value, forest.craft));

  constructor(services: Services) {
    super(services, forest);
    const projectId = computed(() => services.projects.document.value.id);
    effect(() => {
      const opened = this.#opened.value;
      if (opened) sessionStorage.setItem(openKey, JSON.stringify(opened));
    });
    effect(() => {
      const { scene } = this.document.value;
      if (this.active.value && scene !== null) void this.#keepScene(scene);
    });
    effect(() => {
      const found = this.result.value as ForestResult | null;
      untracked(() => this.#noteScene(found));
    });
    effect(() => {
      void [this.subject.value, this.asked.value, this.result.value];
      this.cancelOutdatedSolve();
    });
    effect(() => {
      const shown = this.shown.value;
      if (this.active.value) void this.#readResult(shown);
    });
    effect(() => {
      void projectId.value;
      this.chosen.value = null; // it was of another project's scene
    });
    this.plan.startFollowing();
  }

  /** In the project that is open; the next one begins with the relief. */
  show(open: boolean): void {
    this.#opened.value = { project: this.services.projects.document.peek().id, open };
  }

  /** Dropped here, a JSON file is a scene. */
  takes(files: readonly File[]): boolean {
    return this.active.value && files.some(isSceneFile);
  }

  async #readResult(result: ForestResult | null): Promise<void> {
    if (result?.id === this.solid.peek()?.of) return;
    const [glb, scene] = ['forest.glb', 'scene.json'].map((name) => result?.outputs[name]);
    if (result === null || !glb || !scene) {
      this.solid.value = this.shownScene.value = null;
      return;
    }
    const { blobs } = this.services.projects;
    try {
      const made = readScene(await blobs.read(scene.blob));
      const [{ prepareShading }, mesh] = await Promise.all([
        import('../../../view'),
        readSolid(await blobs.read(glb.blob)),
      ]);
      const shading = await prepareShading(mesh);
      if (this.shown.value?.id !== result.id) return;
      this.shownScene.value = made;
      this.solid.value = { mesh: { ...mesh, ...(shading ? { shading } : {}) }, of: result.id };
    } catch {
      this.lose(result); // its bytes were not kept; it can be made again
    }
  }

  /** So that an earlier result can be returned to. */
  #noteScene(result: ForestResult | null): void {
    if (result === null || result.scene !== undefined) return;
    this.services.projects.do(forest.noteScene(result, this.document.value.scene));
  }

  async #keepScene(scene: Scene): Promise<void> {
    const hash = await this.services.projects.blobs.hold(sceneBytes(scene));
    if (this.document.value.scene === scene) this.#kept.value = { scene, hash };
  }

  /** Large files may have taken its place in memory. */
  async #ready(): Promise<void> {
    const { scene } = this.document.value;
    if (scene !== null) await this.#keepScene(scene);
  }

  async make(): Promise<void> {
    this.#nameProject();
    await this.#ready();
    await solveInFull(this);
  }

  async outputOf(name: string, label: string): Promise<Uint8Array<ArrayBuffer> | null> {
    await this.#ready();
    return await outputOf(this, name, label);
  }

  // ---- the scene ----

  /** `coalesce`: while something is dragged; `commit` ends the step. */
  change(change: (scene: Scene) => Scene, label: string, coalesce?: string): void {
    const scene = this.scene.value;
    const operation = this.operation.value;
    if (scene === null || operation === null) return;
    this.#nameProject();
    this.services.projects.do(forest.setScene(operation, change(scene), label, coalesce));
    if (coalesce === undefined) this.commit();
  }

  commit(): void {
    this.services.projects.commit();
  }

  useSample(): void {
    this.services.projects.do(forest.useSample());
    this.chosen.value = null;
    this.commit();
  }

  /** What a pillar is like that is the first of its scene: as layouts make them. */
  firstPillar(): Pillar {
    const value = (name: string) => {
      const operation = this.operation.value;
      return Number(operation && inForce(operation, this.document.value.parameters, name));
    };
    return {
      shape: 'square',
      x_mm: 0,
      y_mm: 0,
      width_mm: value('pillar_width_mm'),
      height_mm: value('pillar_height_mm'),
    };
  }

  setSource(viewpoint: number, source: Source): void {
    this.change(
      (scene) => changeViewpoint(scene, viewpoint, (one) => withSource(one, source)),
      'Choose a model',
    );
  }

  /** A model of another room takes the place of a viewpoint's. */
  takeModel(viewpoint: number, model: CraftModel): void {
    const title = titleOf(model.source).replace(/\.[^.]+$/, '');
    void this.#addModels([{ file_name: `${title}.ply`, file: model.mesh }], viewpoint);
  }

  /** Models for the chosen viewpoint and those after it, or a scene. */
  async openFiles(files: readonly File[]): Promise<boolean> {
    const sceneFile = files.find(isSceneFile);
    if (sceneFile) return await this.#openScene(sceneFile);
    const kept = [];
    for (const file of files)
      kept.push({
        file_name: file.name,
        file: await this.keep(
          new Uint8Array(await file.arrayBuffer()),
          file.type || 'application/octet-stream',
        ),
      });
    const chosen = this.chosen.value;
    return await this.#addModels(kept, chosen?.kind === 'viewpoint' ? chosen.index : 0);
  }

  async #addModels(models: ForestDocument['models'], first: number): Promise<boolean> {
    const scene = this.scene.value;
    const operation = this.operation.value;
    const [one] = models;
    if (scene === null || operation === null || one === undefined) return false;
    const before = this.document.value.models;
    const changed = models.reduce(
      (next, _, i) =>
        changeViewpoint(next, first + i, (viewpoint) =>
          withSource(viewpoint, { model: before.length + i + 1 }),
        ),
      scene,
    );
    const name = one.file_name;
    const opened = await this.busy(
      'opening',
      name,
      async (options) => {
        await this.#readByCore(sceneBytes(changed), [...before, ...models], options).catch(
          (thrown: unknown) => {
            // What the scene lacks is said of it as it stands, with the model in its place.
            const { code, where } = asJobError(thrown);
            if (code !== 'invalid_input' || isModelInput(where)) throw thrown;
          },
        );
        this.#nameProject(options.do);
        options.do(forest.addModels(operation, models, changed, `Open ${name}`));
        this.commit();
        return true;
      },
      this.#couldNotOpen(name),
    );
    return opened ?? false;
  }

  async #openScene(file: File): Promise<boolean> {
    const opened = await this.busy(
      'opening',
      file.name,
      async (options) => {
        const bytes = new Uint8Array(await file.arrayBuffer());
        const scene = await this.#readByCore(bytes, this.document.value.models, options);
        const operation = this.operation.value;
        if (operation) options.do(forest.setScene(operation, scene, `Open ${file.name}`));
        this.commit();
        return true;
      },
      this.#couldNotOpen(file.name),
    );
    return opened ?? false;
  }

  /** The scene with its models: throws what the core refuses. */
  async #readByCore(
    bytes: Uint8Array<ArrayBuffer>,
    models: ForestDocument['models'],
    options: BusyOptions,
  ): Promise<Scene> {
    const { browser, projects } = this.services;
    const { inputs } = subjectOf(await projects.blobs.hold(bytes), models);
    const job = { operation: forestOperation, parameters: {}, inputs, outputs: ['scene.json'] };
    return readScene(await bytesOf(await browser.run(job, options), 'scene.json'));
  }

  #couldNotOpen(name: string) {
    return ({ message }: JobError) =>
      (this.problem.value = { kind: 'file', title: `Could not open ${name}`, message });
  }

  #nameProject(change: Change = (command) => this.services.projects.do(command)): void {
    const { name, crafts } = this.services.projects.document.value;
    const isAlone = Object.keys(crafts).every((craft) => craft === forest.craft);
    if (isAlone && name === 'New project') change(nameProject(projectTitle));
  }

  // ---- what every room does ----

  get title(): string {
    return projectTitle;
  }

  cancelPreview(): void {
    // The plan is quick, and follows what is changed while the forest is made.
  }

  protected follow(): void {
    // Everything that is shown follows the document by itself.
  }

  measured(report: Report): Measured | null {
    const names = ['seconds_read', 'seconds_solve', 'seconds_solids', 'seconds_check', 'seconds_write'];
    const seconds = names.reduce((sum, name) => sum + (figure(report, name) ?? 0), 0);
    const pieces = figure(report, 'pieces');
    return pieces && seconds > 0 ? { vertices: pieces, seconds } : null;
  }

  /** From the last one made, by the number of pieces. */
  readonly estimate = computed(() => {
    const plan = this.plan.planned.value?.plan;
    const pieces = plan?.viewpoints.reduce((sum, { surfaces }) => sum + surfaces.length, 0);
    return pieces ? expectedTimes(forest.craft, pieces, null) : null;
  });
}
