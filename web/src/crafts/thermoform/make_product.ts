// SPDX-License-Identifier: GPL-3.0-or-later
// Prints and moulds of a formed sheet: what is not made yet is made, the sheet first where that is missing.
import type { JobInput, Operation } from '../../jobs/contract';
import { JobError } from '../../jobs/contract';
import type { BlobReference } from '../../project/document';
import type { Source } from '../common/craft_document';
import { known, meshInput } from '../common/craft_document';
import { outputOf, solveInFull } from '../common/full_solve';
import { bytesOf } from '../common/import_model';
import { readyWorker } from '../common/services';
import { addProduct, printing, productOf, simulate } from './thermoform_document';
import type { ThermoformSession } from './thermoform_session';

/** The model's own file keeps what the repaired mesh lost: coordinates of its picture. */
const sourceInput = (source: Source): JobInput =>
  source.kind === 'sample'
    ? { sample: source.sample }
    : { sha256: source.file.blob, file_name: source.file_name };

/** Materials and pictures that came with the model, for the inputs that take such files. */
function companionInputs(operation: Operation, source: Source): Record<string, JobInput> {
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
export async function productBytes(
  session: ThermoformSession,
  operationName: string,
  output: string,
  label: string,
): Promise<Uint8Array<ArrayBuffer> | null> {
  if (session.result.value === null) await solveInFull(session);
  if (session.result.value === null) return null;
  if (operationName === simulate) return await outputOf(session, output, label);
  const operation = session.operationNamed(operationName);
  const { projects } = session.services;
  const { model } = session.document.value;
  const subject = session.subject.value;
  if (operation === undefined || model === null || subject === null) return null;
  const kept = productOf(session.document.value, subject, operation)?.outputs[output];
  if (kept && (await projects.blobs.has(kept.blob))) return await projects.blobs.read(kept.blob);
  const sheet = session.result.value.outputs['sheet.ply'];
  return await session.busy(
    'exporting',
    label,
    async (options) => {
      const backend = readyWorker(session.services) ?? session.services.browser;
      const parameters = known(operation, session.document.value.parameters);
      const declared = operation.inputs.map(({ name }) => name);
      const inputs = {
        mould: operationName === printing ? sourceInput(model.source) : meshInput(model.mesh, 'model.ply'),
        ...(sheet && declared.includes('sheet') ? { sheet: meshInput(sheet, 'sheet.ply') } : {}),
        ...companionInputs(operation, model.source),
        ...session.furtherInputs.value,
      };
      const wanted = wantedWith(operation, output);
      const start = performance.now();
      const done = await backend.run(
        { operation: operationName, parameters, inputs, outputs: wanted },
        options,
      );
      const outputs: Record<string, BlobReference> = {};
      for (const name of wanted) {
        const mediaType = done.outputs.get(name)?.mediaType;
        if (mediaType) outputs[name] = await session.keep(await bytesOf(done, name), mediaType);
      }
      const own = outputs[output];
      if (own === undefined)
        throw new JobError({ code: 'internal', where: output, message: `The solver made no ${output}.` });
      projects.do(
        addProduct({
          id: crypto.randomUUID(),
          operation: operationName,
          made_unix_s: Math.round(Date.now() / 1000),
          backend: backend.kind,
          seconds: (performance.now() - start) / 1000,
          mesh: subject.key,
          parameters,
          report: done.report,
          outputs,
        }),
      );
      return await projects.blobs.read(own.blob);
    },
    (error) => session.report(error, `Could not make the ${label}`),
  );
}

/** What is shown beside what is saved comes of the same run. */
function wantedWith(operation: Operation, output: string): string[] {
  const shown = operation.name === printing ? ['formed.glb', 'print.pdf'] : ['draft.ply'];
  const declared = operation.outputs.map(({ name }) => name);
  return [...new Set([output, ...shown])].filter((name) => declared.includes(name));
}
