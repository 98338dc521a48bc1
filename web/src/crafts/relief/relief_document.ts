// SPDX-License-Identifier: GPL-3.0-or-later
// The relief's part of a project.
import type { JobInput, JsonObject } from '../../jobs/contract';
import type { BlobReference } from '../../project/document';
import type { Companion, CraftDocument, CraftResult, Subject } from '../../shared/session/craft_document';
import { CraftCommands, emptyCraft, sameRequest } from '../../shared/session/craft_document';

/** What is painted on a model. */
export interface Painting {
  /** The mesh whose vertices are painted. */
  readonly on: string;
  /** As the operation reads it; null while nothing is painted. */
  readonly file: BlobReference | null;
}

/** What a relief was made of beside its model and its parameters. */
interface FurtherInputs {
  readonly base: Companion | null;
  readonly painting: Painting | null;
}

export interface ReliefResult extends CraftResult {
  /** Left out until it is written beside it. */
  readonly made_with?: FurtherInputs;
}

export interface ReliefDocument extends CraftDocument {
  /** The file of the surface that the relief is worked into; null for a built-in shape. */
  readonly base: Companion | null;
  /** What differs from the defaults of the light that it is shown in. */
  readonly light: JsonObject;
  /** What was painted last, and on which model. */
  readonly painting: Painting | null;
}

class ReliefCommands extends CraftCommands<ReliefDocument> {
  /** So that an earlier relief can be returned to, with its base and what was painted. */
  noteInputs({ id }: ReliefResult, { base, painting }: ReliefDocument) {
    return this.amendResult(id, (result) => ({ ...result, made_with: { base, painting } }));
  }

  override restoreResult(result: ReliefResult, label: string) {
    return this.command({ label }, () => ({ parameters: result.parameters, ...result.made_with }));
  }
}

export const relief = new ReliefCommands('relief', {
  ...emptyCraft,
  base: null,
  light: {},
  painting: null,
});

/** The operation's input for it. */
export const baseInputs = ({ base }: ReliefDocument): Readonly<Record<string, JobInput>> =>
  base ? { base_mesh: { sha256: base.file.blob, file_name: base.file_name } } : {};

/** Where the base from a file was put; of another file it says nothing. */
export const placesBase = (parameter: string): boolean => parameter.startsWith('base_mesh_');

/** A file takes the place of the built-in shapes. */
export const takeBase = (base: Companion | null) =>
  relief.command({ label: base ? 'Choose a base' : 'Use a built-in base' }, ({ parameters }) => ({
    base,
    parameters: Object.fromEntries(
      Object.entries(parameters).filter(([name]) => !placesBase(name) && !(base && name === 'base')),
    ),
  }));

/** The result made with exactly the parameters and the subject in force, if there is one. */
export function currentResult(
  { parameters, results }: ReliefDocument,
  subject: Subject | null,
): ReliefResult | null {
  if (subject === null) return null;
  const request = { mesh: subject.key, parameters };
  return results.find((result) => sameRequest(result, request)) ?? null;
}

/** Of two subjects: made of one model. */
export const sameMesh = (a: string, b: string | undefined): boolean => a.split('+')[0] === b?.split('+')[0];

/** Those that can be returned to: made of the model in force, on whatever base and with whatever painting it was. */
export const earlierResults = (
  { results }: ReliefDocument,
  subject: Subject | null,
): readonly ReliefResult[] =>
  subject === null
    ? []
    : results.filter(
        ({ mesh, made_with }: ReliefResult) =>
          mesh === subject.key || (made_with !== undefined && sameMesh(mesh, subject.key)),
      );
