// SPDX-License-Identifier: GPL-3.0-or-later
// Chooses the marks to measure, and makes an object of what was measured.
import type { JobInput, JsonObject } from '../../../jobs/contract';
import { isObject, jsonEqual } from '../../../project/document';
import {
  inForce,
  known,
  meshInput,
  modelsElsewhere,
  titleOf,
  withoutDefaults,
} from '../../../shared/session/craft_document';
import { bytesOf } from '../../../shared/session/import_model';
import { machineProfile, profileInputs } from '../../../shared/session/machine_profile';
import { readyWorker } from '../../../shared/session/services';
import { evidence, planning } from '../evidence_document';
import type { EvidenceSession } from '../evidence_session';
import { takeObject } from '../objects/take_files';
import type { ByHand, HandMould } from './hand_marks';
import { marksIn, measuredMarks, measuredTable, pairIn } from './hand_marks';
import { measuredRim, rimIn } from './rim';

const formingRoom = 'thermoform';

/** Moulds to choose from: models of other rooms first, with the machine's settings of the thermoforming room. */
export function moulds(session: EvidenceSession): HandMould[] {
  const { projects, catalog } = session.services;
  const document = projects.document.value;
  const forming = document.crafts[formingRoom];
  const operation = session.operationNamed(planning);
  const stored = isObject(forming) && isObject(forming['parameters']) ? forming['parameters'] : {};
  const parameters = operation ? known(operation, stored) : {};
  return [
    ...modelsElsewhere(document, 'evidence').map(({ source, mesh }): HandMould => ({
      kind: 'model',
      title: titleOf(source),
      mesh,
      parameters,
    })),
    ...(catalog.value?.samples ?? []).map(({ name, title }): HandMould => ({
      kind: 'sample',
      sample: name,
      title,
    })),
  ];
}

export function begin(session: EvidenceSession): void {
  const all = moulds(session);
  const usual =
    all.find(({ kind }) => kind === 'model') ?? all.find((one) => one.title === 'Pyramid') ?? all[0];
  if (usual === undefined) return;
  const byHand: ByHand = { mould: usual, parameters: {}, origin: 'corner', marks: [], plan: null };
  session.services.projects.do(evidence.setByHand(byHand, 'Measure by hand'));
  session.services.projects.commit();
}

export const keyOf = (mould: HandMould): string =>
  mould.kind === 'sample' ? `sample ${mould.sample}` : `model ${mould.mesh.blob}`;

/** What the marks are chosen for. Typed numbers are no part of it: they only add marks. */
function requestOf(session: EvidenceSession, { mould, parameters }: ByHand): JsonObject {
  const operation = session.operationNamed(planning);
  const own = { ...(mould.kind === 'model' ? mould.parameters : {}), ...parameters };
  return { mould: keyOf(mould), parameters: operation ? withoutDefaults(operation, own) : own };
}

/** The plan, where it is of the mould and settings in force. */
export const planNow = (session: EvidenceSession, byHand: ByHand) =>
  byHand.plan && jsonEqual(byHand.plan.of, requestOf(session, byHand)) ? byHand.plan : null;

export const openingOf = ({ plan }: ByHand): readonly [number, number] =>
  (plan && pairIn(plan.report, 'opening_mm')) ?? [0, 0];

function sigmaOf(session: EvidenceSession, { parameters }: ByHand): number {
  const operation = session.operationNamed(planning);
  return Number((operation && inForce(operation, parameters, 'gauge_sigma_mm')) ?? 0);
}

/** Chooses marks beside those that are measured; those without numbers make room. */
export async function planMarks(session: EvidenceSession, byHand: ByHand): Promise<void> {
  const { projects } = session.services;
  const opening = openingOf(byHand);
  const same = planNow(session, byHand) !== null;
  const kept = same ? measuredMarks(byHand, opening) : [];
  const keptRim = same ? measuredRim(byHand.rim ?? []) : [];
  await session.busy(
    'exporting',
    'plan of the marks',
    async (options) => {
      const backend = readyWorker(session.services) ?? session.services.browser;
      const { mould } = byHand;
      const request = requestOf(session, byHand);
      const inputs: Record<string, JobInput> = {
        mould: mould.kind === 'sample' ? { sample: mould.sample } : meshInput(mould.mesh, 'mould.ply'),
        ...profileInputs(machineProfile.of(projects.document.value).profile),
      };
      if (kept.length > 0) {
        const table = measuredTable(
          { ...byHand, marks: kept, rim: keptRim },
          opening,
          sigmaOf(session, byHand),
        );
        const { blob } = await session.keep(new TextEncoder().encode(table), 'text/csv');
        inputs['measured'] = { sha256: blob, file_name: 'measured.csv' };
      }
      const done = await backend.run(
        {
          operation: planning,
          parameters: request['parameters'] as JsonObject,
          inputs,
          outputs: ['mould.obj', 'setup.json', 'marks.svg'],
        },
        options,
      );
      const plan = {
        of: request,
        report: done.report,
        mould: await session.keep(await bytesOf(done, 'mould.obj'), 'model/obj'),
        setup: await session.keep(await bytesOf(done, 'setup.json'), 'application/json'),
        drawing: await session.keep(await bytesOf(done, 'marks.svg'), 'image/svg+xml'),
      };
      const marks = [...kept, ...marksIn(done.report)];
      const rim = [...(kept.length > 0 ? keptRim : []), ...rimIn(done.report)];
      options.do(evidence.changeByHand({ plan, marks, rim }, 'Choose the marks'));
    },
    (error) => session.report(error, 'Could not choose the marks'),
  );
}

/** The measured marks become an object of the room. */
export async function takeMarks(session: EvidenceSession, byHand: ByHand): Promise<void> {
  const { plan, mould } = byHand;
  if (plan === null) return;
  const { blobs } = session.services.projects;
  const name = mould.title.replace(/\.[^.]+$/, '');
  await session.busy(
    'opening',
    name,
    async (options) => {
      const table = measuredTable(byHand, openingOf(byHand), sigmaOf(session, byHand));
      const files = {
        'mould.obj': await blobs.read(plan.mould.blob),
        'setup.json': await blobs.read(plan.setup.blob),
        'measured.csv': new TextEncoder().encode(table),
      };
      await takeObject(session, { name, files }, options.do);
      options.do(evidence.setByHand(null, 'Use the measured marks'));
    },
    (error) => session.report(error, 'Could not use the measured marks'),
  );
}
