// @vitest-environment happy-dom
// SPDX-License-Identifier: GPL-3.0-or-later
import { expect, it } from 'vitest';
import { testCatalog, testServices } from '../common/test_room';
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
