// SPDX-License-Identifier: GPL-3.0-or-later
// How measured objects and scans come into the project.
import type { ReadonlySignal, Signal } from '@preact/signals';
import type { Operation } from '../../../jobs/contract';
import type { BlobReference } from '../../../project/document';
import { toast } from '../../../ui';
import { nameProject } from '../../../shared/session/craft_document';
import type { Change } from '../../../shared/session/room_session';
import type { Services } from '../../../shared/session/services';
import type { EvidenceDocument, MeasuredObject, ObjectFile, Scan } from '../evidence_document';
import { evidence, freeName, objectFiles, photographing, registering } from '../evidence_document';
import type { Bytes, Found } from './measured_files';
import { countReadings, missingFrom, packObject, plainName } from './measured_files';
import { arePhotographs, photographInputs, scanInputs } from '../scan/scan_files';

/** The part of the room that files are taken into. */
interface ObjectShelf {
  readonly services: Services;
  readonly document: ReadonlySignal<EvidenceDocument>;
  readonly chosenId: Signal<string | null>;
  keep(bytes: Bytes, media_type: string): Promise<BlobReference>;
  operationNamed(name: string): Operation | undefined;
}

/** Together with files that came before, where it is not complete. */
export async function takeObject(
  session: ObjectShelf,
  { name: own, files }: Found,
  change: Change,
): Promise<void> {
  const { projects } = session.services;
  const { draft, objects } = session.document.value;
  const name = draft && own === plainName ? draft.name : own;
  const whole: Partial<Record<ObjectFile, Bytes>> = {};
  for (const file of objectFiles) {
    const kept = draft?.files[file];
    const bytes = files[file] ?? (kept ? await projects.blobs.read(kept.blob) : undefined);
    if (bytes) whole[file] = bytes;
  }
  const references = await Promise.all(
    objectFiles.map(async (file) => {
      const bytes = whole[file];
      const type = {
        'mould.obj': 'model/obj',
        'setup.json': 'application/json',
        'measured.csv': 'text/csv',
      }[file];
      return bytes ? ([[file, await session.keep(bytes, type)]] as const) : [];
    }),
  );
  const kept = Object.fromEntries(references.flat());
  const first = projects.isBlank.value && projects.document.value.name === 'New project';
  if (missingFrom(whole) !== '') {
    change(evidence.setDraft({ name, files: kept }, `Open ${name}`));
    return;
  }
  const pack = await session.keep(packObject(whole as Record<ObjectFile, Bytes>), 'application/zip');
  const same = objects.find((object) => object.pack.blob === pack.blob);
  if (same) {
    toast(`${same.name} is here already.`);
    session.chosenId.value = same.id;
    return;
  }
  const object: MeasuredObject = {
    id: crypto.randomUUID(),
    name: freeName(name, objects),
    pack,
    files: kept as MeasuredObject['files'],
    ...countReadings(whole['measured.csv'] as Bytes),
    use: 'fit',
  };
  change(evidence.addObject(object));
  if (first) change(nameProject(object.name));
  session.chosenId.value = object.id;
}

export async function takeScan(
  session: ObjectShelf,
  dropped: readonly File[],
  change: Change,
): Promise<void> {
  const before = session.document.value.scan;
  const had = (wanted: RegExp) => before?.files.filter(({ input }) => wanted.test(input)) ?? [];
  const photographs = arePhotographs(dropped, {
    photographs: before?.operation === photographing,
    scan: had(/^scan$/).length > 0,
  });
  const operation = photographs ? photographing : registering;
  // What lay there for the other way of measuring is of no use to this one, its pattern apart.
  const kept = (before?.files ?? []).filter(
    ({ input }) => operation === (before?.operation ?? registering) || input === 'pattern',
  );
  const inputs = photographs
    ? photographInputs(dropped, kept.filter(({ input }) => input !== 'pattern').length)
    : scanInputs(dropped, session.operationNamed(registering));
  const added = await Promise.all(
    inputs.map(async ({ input, file }) => ({
      input,
      file_name: file.name,
      file: await session.keep(
        new Uint8Array(await file.arrayBuffer()),
        file.type || 'application/octet-stream',
      ),
    })),
  );
  const others = kept.filter((old) => !added.some(({ input }) => input === old.input));
  const files = [...others, ...added];
  const parameters = operation === (before?.operation ?? registering) ? (before?.parameters ?? {}) : {};
  const scan: Scan = { operation, files, corners: null, parameters, measured: null };
  change(evidence.setScan(scan, photographs ? 'Open photographs' : 'Open a scan'));
}
