// SPDX-License-Identifier: GPL-3.0-or-later
// The relief's part of a project.
import type { CraftDocument, CraftResult } from '../../shared/session/craft_document';
import { CraftCommands, emptyCraft, sameRequest } from '../../shared/session/craft_document';

export const relief = new CraftCommands<CraftDocument>('relief', emptyCraft);

/** The result made with exactly the parameters and the model in force, if there is one. */
export function currentResult({ model, parameters, results }: CraftDocument): CraftResult | null {
  if (model === null) return null;
  const request = { mesh: model.mesh.blob, parameters };
  return results.find((result) => sameRequest(result, request)) ?? null;
}
