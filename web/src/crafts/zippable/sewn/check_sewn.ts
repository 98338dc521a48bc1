// SPDX-License-Identifier: GPL-3.0-or-later
// From a design to the lengths that tell most, and from these to what goes wrong when it is cut and sewn.
import { zipSync } from 'fflate';
import type { Result } from '../../../jobs/backend';
import type { JobInput, JsonObject } from '../../../jobs/contract';
import { isObject } from '../../../project/document';
import { known } from '../../../shared/session/craft_document';
import { solveInFull } from '../../../shared/session/full_solve';
import { bytesOf } from '../../../shared/session/import_model';
import type { BusyOptions } from '../../../shared/session/room_session';
import { readyWorker } from '../../../shared/session/services';
import { planBytes } from '../make_product';
import { errorsOfMaking, planning, simulating, withoutErrors, zippable } from '../zippable_document';
import type { ZippableSession } from '../zippable_session';
import type { SewnCheck } from './sewn_lengths';
import { inOrder, lengthsCsv, lengthsIn } from './sewn_lengths';

const choosing = 'evidence-plan-lengths';
const diagnosing = 'evidence-diagnose-zippable';

export const canCheck = (session: ZippableSession): boolean =>
  [choosing, diagnosing].every((name) => session.operationNamed(name) !== undefined);

/** The check of the design in force. */
export const checkNow = (session: ZippableSession): SewnCheck | null => {
  const { sewn } = session.document.value;
  return sewn && sewn.design === session.designFile.value?.blob ? sewn : null;
};

export const setSewn = (sewn: SewnCheck | null, label: string, coalesce?: string) =>
  zippable.command({ label, ...(coalesce ? { coalesce } : {}) }, () => ({ sewn }));

function run(
  session: ZippableSession,
  operation: string,
  inputs: Readonly<Record<string, JobInput>>,
  parameters: JsonObject,
  outputs: readonly string[],
  options: BusyOptions,
): Promise<Result> {
  const backend = readyWorker(session.services) ?? session.services.browser;
  return backend.run({ operation, parameters, inputs, outputs: [...outputs] }, options);
}

/** Lengths to measure of the design in force; the design in full and its plan first. */
export async function chooseLengths(session: ZippableSession): Promise<void> {
  if (session.result.value === null) await solveInFull(session);
  const design = session.designFile.value;
  if (design === null) return;
  const plan = await planBytes(session, 'plan.json', 'plan');
  if (plan === null) return;
  await session.busy(
    'exporting',
    'lengths to measure',
    async (options) => {
      const kept = await session.keep(plan, 'application/json');
      const inputs = {
        design: { sha256: design.blob, file_name: 'design.json' },
        plan: { sha256: kept.blob, file_name: 'plan.json' },
      };
      const { report } = await run(session, choosing, inputs, {}, [], options);
      const outlook = report['sentence'];
      const sewn: SewnCheck = {
        design: design.blob,
        plan: kept,
        corrected: correctedNow(session),
        outlook: typeof outlook === 'string' ? outlook : '',
        lengths: inOrder(lengthsIn(report)),
        found: null,
      };
      options.do(setSewn(sewn, 'Choose lengths to measure'));
    },
    (error) => session.report(error, 'Could not choose the lengths'),
  );
}

/** What the simulation knows of the cloth, without the errors that are looked for. */
function setup(session: ZippableSession): JsonObject {
  const operation = session.operationNamed(simulating);
  return operation ? withoutErrors(operation, known(operation, session.document.value.parameters)) : {};
}

/** What the plan in force makes up for. */
function correctedNow(session: ZippableSession): Record<string, number> {
  const properties = session.operationNamed(planning)?.parameters.properties ?? {};
  const names = Object.keys(properties).filter((name) => properties[name]?.['x-group'] === errorsOfMaking);
  return Object.fromEntries(
    names.flatMap((name) => {
      const value = session.value(name);
      return typeof value === 'number' && value !== 0 ? [[name, value]] : [];
    }),
  );
}

export async function diagnoseSewn(session: ZippableSession, check: SewnCheck): Promise<void> {
  const csv = lengthsCsv(check.lengths);
  await session.busy(
    'exporting',
    'diagnosis',
    async (options) => {
      const { blobs } = session.services.projects;
      const [design, plan] = await Promise.all([blobs.read(check.design), blobs.read(check.plan.blob)]);
      const text = new TextEncoder();
      const old = { mtime: new Date(1980, 0, 1) } as const;
      const pack = zipSync({
        'design.json': [design, old],
        'plan.json': [plan, old],
        'setup.json': [text.encode(JSON.stringify(setup(session))), old],
        'lengths.csv': [text.encode(csv), old],
      }) as Uint8Array<ArrayBuffer>;
      const object = await session.keep(pack, 'application/zip');
      const inputs = { object: { sha256: object.blob, file_name: `${session.title}.zip` } };
      const made = await run(session, diagnosing, inputs, { pairs: false }, ['profile.json'], options);
      const profile = JSON.parse(new TextDecoder().decode(await bytesOf(made, 'profile.json'))) as unknown;
      const values = isObject(profile) && isObject(profile['parameters']) ? profile['parameters'] : {};
      const errors = Object.fromEntries(
        Object.entries(values).flatMap(([name, value]) => (typeof value === 'number' ? [[name, value]] : [])),
      );
      const found = { of: csv, report: made.report, errors };
      options.do(setSewn({ ...check, found }, 'Diagnose what was sewn'));
    },
    (error) => session.report(error, 'Could not diagnose what was sewn'),
  );
}

/** What was found is what the plan did not make up for yet. */
function wantedOf({ corrected, found }: SewnCheck): Record<string, number> {
  const wanted: Record<string, number> = { ...corrected };
  for (const [name, value] of Object.entries(found?.errors ?? {})) wanted[name] = (wanted[name] ?? 0) + value;
  return wanted;
}

const near = (a: number, b: number) => Math.abs(a - b) < 1e-9;

export function isUsed(session: ZippableSession, check: SewnCheck): boolean {
  const now = correctedNow(session);
  const wanted = wantedOf(check);
  return [...new Set([...Object.keys(now), ...Object.keys(wanted)])].every((name) =>
    near(now[name] ?? 0, wanted[name] ?? 0),
  );
}

/** Later plans of this project make up for what was found. */
export function useInPlan(session: ZippableSession, check: SewnCheck): void {
  session.setParameters(wantedOf(check), 'Make up for what was found');
}
