// SPDX-License-Identifier: GPL-3.0-or-later
// Prints and moulds of a formed sheet: what is not made yet is made, the sheet first where that is missing.
import type { JobInput, Operation } from '../../jobs/contract';
import type { CraftModel, Source } from '../../shared/session/craft_document';
import { meshInput } from '../../shared/session/craft_document';
import { outputOf, solveInFull } from '../../shared/session/full_solve';
import { profileInputs } from '../../shared/session/machine_profile';
import { productBytes } from '../../shared/session/products';
import { printing, simulate } from './thermoform_document';
import type { ThermoformSession } from './thermoform_session';

/** The model's own file keeps what the repaired mesh lost: coordinates of its picture. */
export function sourceInput({ source, mesh }: CraftModel): JobInput {
  if (source.kind === 'sample') return { sample: source.sample };
  return source.kind === 'file'
    ? { sha256: source.file.blob, file_name: source.file_name }
    : meshInput(mesh, 'model.ply');
}

/** Materials and pictures that came with the model, for the inputs that take such files. */
export function companionInputs(operation: Operation, source: Source): Record<string, JobInput> {
  const companions = source.kind === 'file' ? (source.companions ?? []) : [];
  const inputs: Record<string, JobInput> = {};
  for (const { name, extensions = [] } of operation.inputs) {
    const fits = companions.find(({ file_name }) =>
      extensions.some((ending) => file_name.toLowerCase().endsWith(`.${ending}`)),
    );
    if (fits && name !== 'mould' && name !== 'sheet')
      inputs[name] = { sha256: fits.file.blob, file_name: fits.file_name };
  }
  return inputs;
}

/** The bytes of an output of any of the operations, with the parameters in force. Null: failed or cancelled,
 *  which the page has said. */
export async function bytesToSave(
  session: ThermoformSession,
  operationName: string,
  output: string,
  label: string,
): Promise<Uint8Array<ArrayBuffer> | null> {
  if (session.result.value === null) await solveInFull(session);
  if (session.result.value === null) return null;
  if (operationName === simulate) return await outputOf(session, output, label);
  const operation = session.operationNamed(operationName);
  const { model } = session.document.value;
  const from = session.subject.value?.key;
  if (operation === undefined || model === null || from === undefined) return null;
  const sheet = session.result.value.outputs['sheet.ply'];
  const takesSheet = operation.inputs.some(({ name }) => name === 'sheet');
  const inputs = {
    mould: operationName === printing ? sourceInput(model) : meshInput(model.mesh, 'model.ply'),
    ...(sheet && takesSheet ? { sheet: meshInput(sheet, 'sheet.ply') } : {}),
    ...companionInputs(operation, model.source),
    ...profileInputs(session.profile.value),
  };
  const beside = operationName === printing ? ['formed.glb', 'print.pdf'] : ['draft.ply'];
  return await productBytes(session, { operation, from, inputs, output, beside, label });
}
