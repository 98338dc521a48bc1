// SPDX-License-Identifier: GPL-3.0-or-later
import type { JsonObject } from '../../../jobs/contract';
import { bytesOf } from '../../../shared/session/import_model';
import { inventing } from '../evidence_document';
import type { EvidenceSession } from '../evidence_session';
import { objectsInArchive } from './measured_files';
import { takeObject } from './take_files';

/** An object that nobody made, with faults that are known. */
export async function inventObject(
  session: EvidenceSession,
  sample: string,
  parameters: JsonObject,
): Promise<boolean> {
  const made = await session.busy(
    'opening',
    'a virtual object',
    async (options) => {
      const done = await session.services.browser.run(
        { operation: inventing, parameters, inputs: { mould: { sample } }, outputs: ['object.zip'] },
        options,
      );
      for (const found of objectsInArchive(await bytesOf(done, 'object.zip'), `virtual ${sample}.zip`))
        await takeObject(session, found, options.do);
      return true;
    },
    (error) => session.report(error, 'Could not make a virtual object'),
  );
  return made ?? false;
}
