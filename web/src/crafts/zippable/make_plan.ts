// SPDX-License-Identifier: GPL-3.0-or-later
// Plans of the design in force: made when they are looked at or saved, the design in full first.
import { solveInFull } from '../common/full_solve';
import { productBytes } from '../common/products';
import { planning } from './zippable_document';
import type { ZippableSession } from './zippable_session';

/** The bytes of a file of the plan. Null: failed or cancelled, which the page has said. */
export async function planBytes(
  session: ZippableSession,
  output: string,
  label: string,
): Promise<Uint8Array<ArrayBuffer> | null> {
  if (session.result.value === null) await solveInFull(session);
  const design = session.designFile.value;
  const operation = session.operationNamed(planning);
  if (design === null || operation === undefined) return null;
  const inputs = { design: { sha256: design.blob, file_name: 'design.json' } };
  return await productBytes(session, {
    operation,
    from: design.blob,
    inputs,
    output,
    beside: ['plan.svg'],
    label,
  });
}
