// SPDX-License-Identifier: GPL-3.0-or-later
// The model's own colours on the sheet of a preview. Prints of full results are kept (`make_product.ts`), this is not.
import { readPrinted } from '../../jobs/mesh_reader';
import type { Printed } from '../../jobs/glb';
import { known } from '../../shared/session/craft_document';
import { bytesOf } from '../../shared/session/import_model';
import { profileInputs } from '../../shared/session/machine_profile';
import { companionInputs, sourceInput } from './make_product';
import { printing } from './thermoform_document';
import type { Formed, ThermoformSession } from './thermoform_session';

/** Null where this build cannot print, or the sheet is not a preview's. */
export async function previewPrint(session: ThermoformSession, of: Formed): Promise<Printed | null> {
  const operation = session.operationNamed(printing);
  const { model } = session.document.peek();
  if (operation === undefined || model === null || of.sheetFile === undefined) return null;
  const { browser, projects } = session.services;
  const sheet = await projects.blobs.hold(of.sheetFile);
  const done = await browser.run({
    operation: printing,
    parameters: known(operation, of.parameters),
    inputs: {
      ...companionInputs(operation, model.source),
      mould: sourceInput(model),
      sheet: { sha256: sheet, file_name: 'sheet.ply' },
      ...profileInputs(session.profile.peek()),
    },
    outputs: ['formed.glb'],
  });
  return await readPrinted(await bytesOf(done, 'formed.glb'));
}
