// SPDX-License-Identifier: GPL-3.0-or-later
// The forest's part of a project.
import type { JobInput, JsonObject, Operation } from '../../../jobs/contract';
import { jsonEqual } from '../../../project/document';
import type { Companion, CraftResult, RoomDocument, Subject } from '../../../shared/session/craft_document';
import {
  emptyRoom,
  RoomCommands,
  sameRequest,
  withoutDefaults,
} from '../../../shared/session/craft_document';
import type { Scene } from './scene';
import { sceneJson } from './scene';

export const forestOperation = 'relief-forest';

export interface ForestResult extends CraftResult {
  /** It was made of; left out until it is written beside it. */
  readonly scene?: Scene | null;
}

export interface ForestDocument extends RoomDocument {
  /** Null: the scene that is built into the core. */
  readonly scene: Scene | null;
  /** Files that viewpoints refer to by their number, from 1. They stay in their places. */
  readonly models: readonly Companion[];
  readonly results: readonly ForestResult[];
}

const emptyForest: ForestDocument = { ...emptyRoom, scene: null, models: [], results: [] };

/** Pillars come from the scene only while no layout makes others. */
const byHand = (operation: Operation, parameters: JsonObject): JsonObject =>
  withoutDefaults(operation, { ...parameters, layout: 'scene' });

class ForestCommands extends RoomCommands<ForestDocument> {
  /** What a layout has made goes on as a scene set by hand. */
  setScene(operation: Operation, scene: Scene, label: string, coalesce?: string) {
    return this.command({ label, ...(coalesce ? { coalesce } : {}) }, ({ parameters }) => ({
      scene,
      parameters: byHand(operation, parameters),
    }));
  }

  addModels(operation: Operation, models: readonly Companion[], scene: Scene, label: string) {
    return this.command({ label }, ({ models: before, parameters }) => ({
      models: [...before, ...models],
      scene,
      parameters: byHand(operation, parameters),
    }));
  }

  /** Back to the built-in scene. Files stay for another one. */
  useSample() {
    return this.command({ label: 'Start again from the sample' }, ({ parameters }) => {
      const { layout: _, ...others } = parameters;
      return { scene: null, parameters: others };
    });
  }

  returnTo(result: ForestResult, label: string) {
    return this.command({ label }, ({ scene }) => ({
      scene: result.scene === undefined ? scene : result.scene,
      parameters: result.parameters,
    }));
  }

  noteScene({ id }: ForestResult, scene: Scene | null) {
    return this.amendResult(id, (result) => {
      const picture = result.outputs['overview.png'];
      return { ...result, scene: scene && sceneJson(scene), ...(picture ? { picture } : {}) };
    });
  }
}

export const forest = new ForestCommands('forest', emptyForest);

/** `hash`: of the scene's file; null for the built-in one. */
export function subjectOf(hash: string | null, models: readonly Companion[]): Subject {
  const scene: Record<string, JobInput> =
    hash === null ? {} : { scene: { sha256: hash, file_name: 'scene.json' } };
  const files = models.map(({ file_name, file }, i): [string, JobInput] => [
    i === 0 ? 'model' : `model_${i + 1}`,
    { sha256: file.blob, file_name },
  ]);
  return {
    key: [hash ?? 'sample', ...models.map(({ file }) => file.blob)].join('+'),
    inputs: { ...scene, ...Object.fromEntries(files) },
  };
}

export const resultOf = (
  { parameters, results }: ForestDocument,
  subject: Subject | null,
): ForestResult | null =>
  (subject && results.find((one) => sameRequest(one, { mesh: subject.key, parameters }))) ?? null;

export const sameScene = (a: Scene | null, b: Scene | null): boolean =>
  jsonEqual(a && sceneJson(a), b && sceneJson(b));
