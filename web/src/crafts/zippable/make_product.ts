// SPDX-License-Identifier: GPL-3.0-or-later
// What is made of the design in force, when it is looked at or saved: plans to cut, a simulated zipping. The design in full first.
import { solveInFull } from '../../shared/session/full_solve';
import { productBytes } from '../../shared/session/products';
import { planning, simulating } from './zippable_document';
import type { ZippableSession } from './zippable_session';

async function madeOf(
  session: ZippableSession,
  operationName: string,
  output: string,
  label: string,
  beside: readonly string[],
): Promise<Uint8Array<ArrayBuffer> | null> {
  if (session.result.value === null) await solveInFull(session);
  const design = session.designFile.value;
  const operation = session.operationNamed(operationName);
  if (design === null || operation === undefined) return null;
  const inputs = { design: { sha256: design.blob, file_name: 'design.json' } };
  const planned = operationName === planning;
  if (planned) session.sheets.note();
  return await productBytes(session, {
    operation,
    from: design.blob,
    inputs,
    output,
    beside,
    label,
    parameters: planned ? session.sheets.parameters.value : session.clothParameters.value,
  });
}

/** The bytes of a file of the plan. Null: failed or cancelled, which the page has said. */
export const planBytes = (session: ZippableSession, output: string, label: string) =>
  madeOf(session, planning, output, label, [
    'plan.svg',
    ...(session.value('rig') === true ? ['rig.svg'] : []),
  ]);

/** The same of a simulated zipping. */
export const simulationBytes = (session: ZippableSession, output: string, label: string) =>
  madeOf(session, simulating, output, label, ['zipping.glb']);
