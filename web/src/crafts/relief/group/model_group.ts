// SPDX-License-Identifier: GPL-3.0-or-later
// Several models in one relief: each is moved, turned and scaled, and the core makes one model of them.
import type { ReadonlySignal } from '@preact/signals';
import { computed, effect, signal } from '@preact/signals';
import type { JsonObject } from '../../../jobs/contract';
import { asJobError, findOperation, JobError } from '../../../jobs/contract';
import { LatestOnly } from '../../../jobs/latest_only';
import type {
  CraftModel,
  GroupSource,
  PlacedModel,
  SingleSource,
} from '../../../shared/session/craft_document';
import { titleOf } from '../../../shared/session/craft_document';
import { importedReport } from '../../../shared/session/import_model';
import type { OpenedModel } from '../../../shared/session/opened_model';
import { vectorOf } from '../../../shared/session/report';
import type { RoomSession } from '../../../shared/session/room_session';
import type { ReliefDocument } from '../relief_document';
import type { Vector } from '../../../shared/geometry/rotation';
import type { Box } from './placement';
import { placeBeside, viewAxes } from './placement';

const usualSize_mm = 100;
/** Held to the base, the models seem to lie on it together: thesis, Fig. 3.18. */
const groupOutline_mm = 0.1;

interface Edit {
  readonly models: readonly PlacedModel[];
  readonly label: string;
}

/** What the room offers to it. */
export type GroupRoom = RoomSession<ReliefDocument> & { readonly model: OpenedModel<ReliefDocument> };

const nameOf = (source: SingleSource): string => titleOf(source).replace(/\.[^.]+$/, '');

/** "Cat and Bust", "Cat, Bust and 3 more". */
function groupTitle(models: readonly PlacedModel[]): string {
  const names = models.map(({ name }) => name);
  const [first = 'Models', second] = names;
  if (second === undefined) return first;
  return names.length === 2 ? `${first} and ${second}` : `${first}, ${second} and ${names.length - 2} more`;
}

/** A single model may stand out at its outline; several lie on their base, unless their maker chose otherwise. */
const lyingOnTheBase = ({ model, parameters }: ReliefDocument): Partial<ReliefDocument> =>
  model?.source.kind === 'group' || parameters['outline_mm'] !== undefined
    ? {}
    : { parameters: { ...parameters, outline_mm: groupOutline_mm } };

/** What was painted stays on models that were only moved: they have the same vertices in the same order. */
const keptPainting =
  (models: readonly PlacedModel[]) =>
  ({ mesh }: CraftModel) =>
  ({ model, painting }: ReliefDocument): Partial<ReliefDocument> => {
    const before = model?.source.kind === 'group' ? model.source.models : [];
    const isMoved =
      before.length === models.length && models.every(({ source }, i) => source === before[i]?.source);
    return painting && painting.on === model?.mesh.blob && isMoved
      ? { painting: { ...painting, on: mesh.blob } }
      : {};
  };

const groupOf = (models: readonly PlacedModel[]): GroupSource => ({
  kind: 'group',
  title: groupTitle(models),
  models,
});

export class ModelGroup {
  /** Which of them is changed. */
  readonly chosen = signal(0);
  /** The chosen one while a hand moves it. */
  readonly held = signal<PlacedModel | null>(null);
  readonly running = signal(false);
  readonly #draft = signal<readonly PlacedModel[] | null>(null);
  /** As they stand, or are about to; null where the model is a single one. */
  readonly models: ReadonlySignal<readonly PlacedModel[] | null>;
  /** An older worker cannot. */
  readonly available = computed(() => {
    const catalog = this.#room.services.catalog.value;
    return catalog !== null && findOperation(catalog, 'combine') !== undefined;
  });
  readonly #room: GroupRoom;
  readonly #edits: LatestOnly<Edit>;

  constructor(room: GroupRoom) {
    this.#room = room;
    this.models = computed(() => this.#draft.value ?? this.#kept());
    this.#edits = new LatestOnly((edit, abort) => this.#make(edit, abort));
    const project = computed(() => room.services.projects.document.value.id);
    effect(() => {
      void project.value;
      this.#edits.cancel();
      this.#draft.value = this.held.value = null;
      this.chosen.value = 0;
    });
  }

  #kept(): readonly PlacedModel[] | null {
    const source = this.#room.document.value.model?.source;
    return source?.kind === 'group' ? source.models : null;
  }

  /** The model that a vertex of them all belongs to, and its first vertex and the next one's. */
  readonly parts = computed(() => {
    const model = this.#room.document.value.model;
    const listed = model?.report['models'];
    if (this.#kept() === null || !Array.isArray(listed)) return null;
    let first = 0;
    return listed.map((one) => {
      const begin = first;
      first += Number((one as JsonObject)['vertices'] ?? 0);
      return { begin, end: first };
    });
  });

  /** Boxes of the models as they were last made. */
  #boxes(model: CraftModel): Box[] {
    const { source, report } = model;
    const listed = report['models'];
    if (source.kind === 'group' && Array.isArray(listed))
      return source.models.map(({ at_mm }, i) => ({
        at_mm,
        size_mm: vectorOf((listed[i] ?? {}) as JsonObject, 'size_mm') ?? [
          usualSize_mm,
          usualSize_mm,
          usualSize_mm,
        ],
      }));
    return [{ at_mm: [0, 0, 0], size_mm: scaledSize(vectorOf(report, 'size_mm')) }];
  }

  /** One more beside those that are there. */
  async add(source: SingleSource): Promise<void> {
    const { model } = this.#room.document.value;
    if (model === null) return;
    const name = nameOf(source);
    await this.#opening(name, async (signal) => {
      const report = await importedReport(this.#room.services.browser, source, { signal });
      const axes = viewAxes(this.#vector('direction'), this.#vector('up'));
      const at_mm = placeBeside(this.#boxes(model), scaledSize(vectorOf(report, 'size_mm')), axes);
      const models = [
        ...this.#modelsOf(model),
        { source, name, size_mm: usualSize_mm, turn_deg: [0, 0, 0] as const, at_mm },
      ];
      await this.#room.model.change(groupOf(models), `Add ${name}`, signal, () => lyingOnTheBase);
      this.chosen.value = models.length - 1;
    });
  }

  /** A model of one of the project's other rooms. */
  async take(model: CraftModel): Promise<void> {
    if (model.source.kind !== 'group') await this.add(model.source);
  }

  async addFile(file: File): Promise<void> {
    const kept = await this.#room.keep(
      new Uint8Array(await file.arrayBuffer()),
      file.type || 'application/octet-stream',
    );
    await this.add({ kind: 'file', file_name: file.name, file: kept });
  }

  #modelsOf({ source }: CraftModel): readonly PlacedModel[] {
    if (source.kind === 'group') return source.models;
    return [{ source, name: nameOf(source), size_mm: usualSize_mm, turn_deg: [0, 0, 0], at_mm: [0, 0, 0] }];
  }

  #vector(name: string): Vector {
    const value = this.#room.value(name);
    return Array.isArray(value) && value.length === 3 ? (value.map(Number) as unknown as Vector) : [0, 0, -1];
  }

  change(index: number, change: Partial<PlacedModel>, label: string): void {
    this.#edit((models) => models.map((one, i) => (i === index ? { ...one, ...change } : one)), label);
  }

  duplicate(index: number): void {
    const model = this.models.value?.[index];
    const { model: whole } = this.#room.document.value;
    if (model === undefined || whole === null) return;
    const boxes = this.#boxes(whole);
    const own = boxes[index];
    if (own === undefined) return;
    const axes = viewAxes(this.#vector('direction'), this.#vector('up'));
    const at_mm = placeBeside(boxes, own.size_mm, axes);
    this.#edit((models) => [...models, { ...model, at_mm }], `Duplicate ${model.name}`);
    this.chosen.value = (this.models.value?.length ?? 1) - 1;
  }

  remove(index: number): void {
    const model = this.models.value?.[index];
    if (model === undefined) return;
    this.#edit((models) => models.filter((_, i) => i !== index), `Remove ${model.name}`);
    this.chosen.value = Math.max(0, Math.min(this.chosen.value, (this.models.value?.length ?? 1) - 1));
  }

  /** What is held is put down. */
  release(label: string): void {
    const held = this.held.value;
    if (held === null) return;
    this.held.value = null;
    this.change(this.chosen.value, held, label);
  }

  #edit(edit: (models: readonly PlacedModel[]) => readonly PlacedModel[], label: string): void {
    const models = this.models.value;
    if (models === null) return;
    const changed = edit(models);
    this.#draft.value = changed;
    this.#edits.request({ models: changed, label });
  }

  async #make({ models, label }: Edit, abort: AbortSignal): Promise<void> {
    this.running.value = true;
    try {
      await this.#room.model.change(groupOf(models), label, abort, keptPainting(models));
    } catch (thrown) {
      const error = asJobError(thrown);
      if (error.code !== 'cancelled')
        this.#room.problem.value = {
          kind: 'file',
          title: 'Could not place the models',
          message: error.message,
        };
    } finally {
      if (this.#draft.value === models) this.#draft.value = null;
      this.running.value = false;
    }
  }

  async #opening(name: string, open: (signal: AbortSignal) => Promise<void>): Promise<void> {
    await this.#room.busy(
      'opening',
      name,
      async ({ signal }) => {
        if (!this.available.value)
          throw new JobError({
            code: 'invalid_input',
            where: '',
            message: 'This version of the worker cannot combine models: update it.',
          });
        await open(signal);
      },
      ({ message }) => (this.#room.problem.value = { kind: 'file', title: `Could not add ${name}`, message }),
    );
  }
}

/** Sizes of a box whose longest side becomes the usual one. */
function scaledSize(size: Vector | null): Vector {
  const longest = size ? Math.max(...size) : 0;
  if (size === null || !(longest > 0)) return [usualSize_mm, usualSize_mm, usualSize_mm];
  return size.map((value) => (value * usualSize_mm) / longest) as unknown as Vector;
}
