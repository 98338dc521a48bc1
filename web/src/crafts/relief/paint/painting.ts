// SPDX-License-Identifier: GPL-3.0-or-later
// The painting in the relief's document: on which model, and the file that the operation reads.
import type { JobInput } from '../../../jobs/contract';
import { meshInput } from '../../../shared/session/craft_document';
import type { Painting, ReliefDocument } from '../relief_document';
import { relief } from '../relief_document';

/** That of the model in force. */
export const paintingOf = ({ model, painting }: ReliefDocument): Painting | null =>
  model !== null && painting?.on === model.mesh.blob ? painting : null;

/** The operation's inputs for it: previews are made of a simpler mesh, which takes the painting of this one. */
export function paintingInputs(document: ReliefDocument): Readonly<Record<string, JobInput>> {
  const { model } = document;
  const file = paintingOf(document)?.file;
  if (!model || !file) return {};
  return {
    painting: { sha256: file.blob, file_name: 'painting.json' },
    painted_mesh: meshInput(model.mesh, 'model.ply'),
  };
}

/** `recorded`: false where nobody asked for it, and there is nothing to undo. */
export const setPainting = (painting: Painting, label: string, recorded = true) =>
  relief.command({ label, recorded }, () => ({ painting }) as Partial<ReliefDocument>);
