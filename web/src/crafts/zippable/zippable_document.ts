// SPDX-License-Identifier: GPL-3.0-or-later
// The zippable's part of a project.
import type { CraftDocument, CraftResult } from '../common/craft_document';
import { CraftCommands, emptyCraft, sameRequest } from '../common/craft_document';

export const design = 'zippable-design';

export const zippable = new CraftCommands<CraftDocument>('zippable', emptyCraft);

/** The design made with exactly the parameters and the model in force, if there is one. */
export function currentResult({ model, parameters, results }: CraftDocument): CraftResult | null {
  if (model === null) return null;
  const request = { mesh: model.mesh.blob, parameters };
  return results.find((result) => sameRequest(result, request)) ?? null;
}
