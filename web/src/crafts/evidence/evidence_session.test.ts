// @vitest-environment happy-dom
// SPDX-License-Identifier: GPL-3.0-or-later
import { expect, it, vi } from 'vitest';
import { testCatalog, testServices } from '../../shared/session/test_room';
import type { MeasuredObject } from './evidence_document';
import { diagnosing, evidence } from './evidence_document';
import { EvidenceSession } from './evidence_session';

const file = { blob: 'pack', bytes: 3, media_type: 'application/zip' };
const object: MeasuredObject = {
  id: 'a',
  name: 'A',
  pack: file,
  files: { 'mould.obj': file, 'setup.json': file, 'measured.csv': file },
  points: 3,
  use: 'fit',
};

it('a run was stopped in its own project, not in the one that was opened meanwhile', async () => {
  const services = testServices(testCatalog(diagnosing));
  const session = new EvidenceSession(services);
  services.projects.do(evidence.addObject(object));
  const stopped = session.solve();
  session.cancel();
  await stopped;
  expect(session.stopped.value).toBe(true);
  const left = session.solve();
  await services.projects.create();
  await left;
  expect(session.stopped.value).toBe(false);
});

it('points that are still being read when another project is opened are not written into that one', async () => {
  const services = testServices(testCatalog(diagnosing));
  const session = new EvidenceSession(services);
  services.projects.do(evidence.addObject(object));
  vi.spyOn(session, 'keep').mockImplementation(async () => {
    await services.projects.create();
    return file;
  });
  const points = new File(['u_mm,v_mm\n1,2\n'], 'measured.csv');
  Object.defineProperty(points, 'webkitRelativePath', { value: '' });
  expect(await session.openFiles([points])).toBe(false);
  expect(services.projects.isBlank.value).toBe(true);
  expect(session.problem.value).toBeNull();
});
