// SPDX-License-Identifier: GPL-3.0-or-later
// From a photographed scan to measured points: the picture that corners are set on, the run, what becomes of its points.
import type { Json, JsonObject } from '../../../jobs/contract';
import { readPrinted } from '../../../jobs/mesh_reader';
import { jsonEqual } from '../../../project/document';
import { bytesOf } from '../../../shared/session/import_model';
import { readyWorker } from '../../../shared/session/services';
import type { MeasuredScan, Place, Scan } from '../evidence_document';
import { evidence, photographing, registering } from '../evidence_document';
import type { EvidenceSession } from '../evidence_session';
import { takeObject } from '../objects/take_files';

/** What measures it. */
export const measuringOf = (scan: Scan): string => scan.operation ?? registering;
export const isOfPhotographs = (scan: Scan): boolean => scan.operation === photographing;

/** What it is called in buttons and titles. */
export const wordOf = (scan: Scan): string => (isOfPhotographs(scan) ? 'photographs' : 'scan');

/** In the order that the operation wants them. */
export const cornerNames = ['front left', 'front right', 'back right', 'back left'] as const;

/** "120,80 1900,95 1880,2010 110,1990". */
export const cornersText = (corners: readonly Place[]): string =>
  corners.map((place) => place.map((at) => Number(at.toFixed(1))).join(',')).join(' ');

/** Where hands begin: the sheet seen upright, a little inside of the picture. */
export const firstCorners = (width_px: number, height_px: number): Place[] => {
  const [left, right] = [0.12 * width_px, 0.88 * width_px];
  const [back, front] = [0.12 * height_px, 0.88 * height_px];
  return [
    [left, front],
    [right, front],
    [right, back],
    [left, back],
  ];
};

/** Where the registration saw each corner mark in the picture; null where it did not. */
export function seenCorners({ report }: Pick<MeasuredScan, 'report'>): (Place | null)[] {
  const px = report['corner_px'];
  return cornerNames.map((_, i) => {
    const at: unknown = Array.isArray(px) ? px[i] : null;
    return Array.isArray(at) && typeof at[0] === 'number' && typeof at[1] === 'number'
      ? [at[0], at[1]]
      : null;
  });
}

/** What hands go on from: corners that were found stay where they are. */
export const cornersToMove = (seen: readonly (Place | null)[], size_px: Place): Place[] =>
  firstCorners(...size_px).map((place, i) => seen[i] ?? place);

export function moved(corners: readonly Place[], which: number, by: Place, size_px: Place): Place[] {
  const within = (at: number, most: number) => Math.min(most, Math.max(0, at));
  return corners.map(([x, y], i) =>
    i === which ? [within(x + by[0], size_px[0]), within(y + by[1], size_px[1])] : [x, y],
  );
}

function parametersOf({ parameters, corners }: Scan): JsonObject {
  return { ...parameters, ...(corners ? { corners: cornersText(corners) } : {}) };
}

const requestOf = (scan: Scan): Json => ({
  files: scan.files.map(({ input, file }) => [input, file.blob]),
  parameters: parametersOf(scan),
});

/** What was measured of the scan as it is set now. */
export function measuredNow(scan: Scan): MeasuredScan | null {
  return scan.measured && jsonEqual(scan.measured.of, requestOf(scan)) ? scan.measured : null;
}

/** Inputs that the scan still lacks, in the operation's words. */
export function lacking(session: EvidenceSession, scan: Scan): string[] {
  const inputs = session.operationNamed(measuringOf(scan))?.inputs ?? [];
  const missing = inputs
    .filter(({ name, required }) => required && !scan.files.some(({ input }) => input === name))
    .map(({ label }) => label.toLowerCase());
  const photographs = scan.files.filter(({ input }) => input.startsWith('photograph')).length;
  return isOfPhotographs(scan) && photographs === 1 ? ['a second photograph', ...missing] : missing;
}

/** The picture that belongs to the scan: a file of its own, or inside of a GLB. Null where there is none to show. */
export async function pictureOf(session: EvidenceSession, scan: Scan): Promise<Blob | null> {
  const { blobs } = session.services.projects;
  const own = scan.files.find(({ input }) => input === 'texture');
  if (own) return new Blob([await blobs.read(own.file.blob)], { type: own.file.media_type });
  const glb = scan.files.find(({ input, file_name }) => input === 'scan' && /\.glb$/i.test(file_name));
  if (glb === undefined) return null;
  try {
    const { picture, media_type } = await readPrinted(await blobs.read(glb.file.blob));
    return new Blob([picture], { type: media_type });
  } catch {
    return null; // the core may read more than the page shows
  }
}

export async function measureScan(session: EvidenceSession, scan: Scan): Promise<void> {
  await session.busy(
    'exporting',
    'measured points',
    async (options) => {
      const backend = readyWorker(session.services) ?? session.services.browser;
      const inputs = Object.fromEntries(
        scan.files.map(({ input, file_name, file }) => [input, { sha256: file.blob, file_name }]),
      );
      const picture = isOfPhotographs(scan) ? 'seen.png' : 'aligned.png';
      const outputs = ['measured.csv', picture];
      const done = await backend.run(
        { operation: measuringOf(scan), parameters: parametersOf(scan), inputs, outputs },
        options,
      );
      const measured: MeasuredScan = {
        of: requestOf(scan),
        report: done.report,
        points: await session.keep(await bytesOf(done, 'measured.csv'), 'text/csv'),
        aligned: await session.keep(await bytesOf(done, picture), 'image/png'),
      };
      options.do(evidence.keepMeasuredScan(measured));
    },
    ({ message }) =>
      (session.problem.value = { kind: 'solve', title: `Could not measure the ${wordOf(scan)}`, message }),
  );
}

/** The points go on into an object, to which mould and set-up come. */
export async function takePoints(
  session: EvidenceSession,
  scan: Scan,
  { points }: MeasuredScan,
): Promise<void> {
  const name =
    scan.files.find(({ input }) => input === 'scan')?.file_name.replace(/\.[^.]+$/, '') ??
    (isOfPhotographs(scan) ? 'Photographs' : 'Scan');
  await session.busy(
    'opening',
    name,
    async (options) => {
      const bytes = await session.services.projects.blobs.read(points.blob);
      await takeObject(session, { name, files: { 'measured.csv': bytes } }, options.do);
      options.do(evidence.setScan(null, 'Use the measured points'));
    },
    (error) => session.report(error, 'Could not use the measured points'),
  );
}
